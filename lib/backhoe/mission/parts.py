"""What the mission is made of: way-points, the parts and the call of each.

The library's own plan and trajectory are here; the other parts are taught in lessons of their own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, radians, sin

from numpy.typing import NDArray

from backhoe.basics import inputs
from backhoe.machine import BACKHOE


@dataclass(frozen=True)
class WayPoint:
    """Where the stick's tip and the bucket should be, `time` seconds after the way-point before.

    `target` is (x, y, z) of the stick's tip in the base frame [m] and the bucket joint's angle
    [rad].
    """

    name: str
    time: float
    target: tuple[float, float, float, float]


@dataclass(frozen=True)
class Part:
    """A part of the mission: its call, its units, and the lesson that builds it."""

    call: str
    meaning: str
    lesson: str


PARTS = {
    "plan": Part(
        "plan(cycle) -> list of WayPoint",
        "way-points of dig cycle 0, 1, ...: stick's tip [m], bucket angle [rad], seconds",
        "00",
    ),
    "inverse_kinematics": Part(
        "inverse_kinematics(target) -> q",
        "(x, y, z, bucket angle) [m, rad] to four joint angles [rad]",
        "01",
    ),
    "gravity_torque": Part(
        "gravity_torque(q) -> torque",
        "torque that holds the empty arm still at q [rad], four values [N m]",
        "02",
    ),
    "controller": Part(
        "controller(q_ref, dq_ref, q, dq, dt) -> torque",
        "joint torques [N m] from wanted and measured angles [rad] and speeds [rad/s]",
        "03",
    ),
    "trajectory": Part(
        "trajectory(times, q_way, t) -> q, dq",
        "joint angles (n, 4) at times (n,) to angles and speeds (m, 4) at t (m,)",
        "10",
    ),
}

LIFT_PARTS = {
    "gravity_torque": PARTS["gravity_torque"],
    "inertia_matrix": Part(
        "inertia_matrix(q, load) -> M",
        "inertia matrix (4, 4) [kg m^2] at q [rad] with a load [kg] in the bucket",
        "02",
    ),
}
"""What `lift` takes."""

DRIVE_PARTS = {
    "velocity_controller": Part(
        "velocity_controller(v_ref, omega_ref, v, omega, dt) -> left, right",
        "forces of the tracks [N] from wanted and measured speeds [m/s, rad/s]",
        "04",
    ),
    "tracker": Part(
        "tracker(pose, twist, goal, dt) -> v, omega",
        "speeds [m/s, rad/s] from x, y, heading [m, rad], measured speeds and a tracking.Goal",
        "05",
    ),
    "odometry": Part(
        "odometry(pose, left, right, dt) -> pose",
        "x, y, heading [m, rad] after dt [s] from the measured rates of the sprockets [rad/s]",
        "06",
    ),
    "localisation": Part(
        "localisation(left, right, yaw_rate, fix, dt) -> pose",
        "x, y, heading [m, rad] from encoders and gyro [rad/s] and a fix x, y [m] or None; "
        "its reset(pose) is called at the start",
        "07",
    ),
}
"""What `drive` takes. With one of the last two the machine drives on its own estimate."""

SURVEY_PARTS = {
    "matcher": Part(
        "matcher(left, right) -> disparity",
        "rectified pictures (rows, columns), uint8, to disparities [pixels], NaN where unsure",
        "08",
    ),
    "scan_filter": Part(
        "scan_filter(points, origin) -> keep",
        "points (lines, beams, 3) [m] in the order of the beams, NaN where nothing came back, and "
        "where the laser is, (3,), to True or False for each, (lines, beams)",
        "09",
    ),
    "map": Part(
        "map(resolution) -> a map with insert_scan(points, origin, max_range) and log_odds(points)",
        "edge of a voxel [m]; points (n, 3) and origin (3,) [m]: what lies beyond max_range only "
        "frees, up to there; log-odds (n,), NaN where unknown",
        "09",
    ),
}
"""What `survey` takes; a class will do for the map."""

GRADE_PARTS = {
    "whole_body": Part(
        "whole_body(J, b, preferred, lower, upper) -> v",
        "velocities u, omega, swing, boom, stick, bucket (6,) [m/s, rad/s], within lower and upper "
        "(6,) and near preferred (6,), that move the edge's x, y, z and pitch along b (4,) "
        "[m/s, rad/s]: J v is a share of b, J (4, 6)",
        "12",
    ),
    **{name: DRIVE_PARTS[name] for name in ("odometry", "localisation")},
}
"""What `grade` takes."""

AUTONOMY_PARTS = {
    **{name: DRIVE_PARTS[name] for name in ("odometry", "localisation")},
    "scan_filter": SURVEY_PARTS["scan_filter"],
    "terrain": Part(
        "terrain(corner, rows, columns, cell) -> a map with insert(points, origin, time), heights "
        "and variance",
        "x, y of its first height (2,), cells along y and x, their edge [m]; points (n, 3) of the "
        "ground and where they are seen from (3,) [m]; heights, variance (rows, columns) [m, m^2], "
        "NaN where unknown",
        "09",
    ),
    "dig_choice": Part(
        "dig_choice(heights, deviation, directions, reaches) -> strip or None",
        "heights above the tracks' ground and their deviation (n, m) [m], NaN where unseen, at "
        "directions (n,) from ahead to the left [rad] and reaches (m,) from the swing axis [m]; a "
        "strip has direction [rad], start [m] and depth [m]; None: the heap is gone",
        "14",
    ),
    "primitive": Part(
        "primitive(strip, heights, directions, reaches) -> times, path",
        "times (n,) [s] and x, y, z of the stick's tip in the base frame [m] and bucket angle "
        "[rad], (n, 4), that dig the strip and lift the bucket",
        "10",
    ),
    "planner": Part(
        "planner(start, goal, is_free) -> path",
        "joint angles (n, 4) [rad] from start (4,) to goal (4,); is_free(q (n, 4)) -> (n,) says "
        "where the arm touches nothing",
        "11",
    ),
    "controller": PARTS["controller"],
}
"""What the machine alone takes, `autonomy.run`; a class will do for the terrain."""

STROKE = (
    ("turn to the heap", 4.5, 6.3, 4.2, 60),
    ("cut in", 2.5, 6.0, 1.9, 84),
    ("pull", 2.4, 5.2, 1.55, 83),
    ("curl", 2.0, 5.7, 0.6, 6),
    ("lift", 3.0, 5.8, 3.4, -36),
)
"""Name, seconds, reach from the swing axis [m], height [m], bucket angle [deg] of the digging."""

TIPPING = (("swing to the truck", 4.0, -30), ("tip out", 2.8, 100), ("empty", 0.5, 100))
"""Name, seconds and bucket angle [deg] of what happens above the truck."""

STRIPS = ((0.0, 0.0), (10.0, 0.2), (-10.0, 0.2))
"""Direction [deg] from straight ahead and how much lower to cut [m], cycle after cycle."""

CUTTING = ("cut in", "pull", "curl")
OVER_TRUCK = (0.4, 5.7, 3.9)


def hand_made_plan(
    cycle: int, over_truck: tuple[float, float, float] = OVER_TRUCK
) -> list[WayPoint]:
    """Way-points of one dig-and-load cycle, found by hand for the scene `simulation.LOADING`.

    Args:
        cycle: 0, 1, 2, ...; three strips of the heap take turns.
        over_truck: where the stick's tip is above the truck, x, y, z [m]; the scene's own by
            default.

    Returns:
        The way-points, from above the heap to the empty bucket over the truck.
    """
    direction, lower = STRIPS[inputs.whole(cycle, "cycle", least=0) % len(STRIPS)]
    cosine, sine = cos(radians(direction)), sin(radians(direction))
    waypoints = []
    for name, seconds, reach, height, bucket in STROKE:
        x, y = BACKHOE.base.offset + reach * cosine, reach * sine
        z = height - lower if name in CUTTING else height
        waypoints.append(WayPoint(name, seconds, (x, y, z, radians(bucket))))
    for name, seconds, bucket in TIPPING:
        waypoints.append(WayPoint(name, seconds, (*over_truck, radians(bucket))))
    return waypoints


def smooth_trajectory(times: NDArray, q_way: NDArray, t: NDArray) -> tuple[NDArray, NDArray]:
    """Piecewise cubics through the way-points that never overshoot them (PCHIP).

    Args:
        times: increasing times of the way-points, shape (n,) [s].
        q_way: joint angles there, shape (n, 4) [rad].
        t: times asked for, shape (m,) [s].

    Returns:
        Joint angles and speeds at `t`, shapes (m, 4) [rad, rad/s].
    """
    from scipy.interpolate import PchipInterpolator

    times = inputs.times(times, "times")
    q_way = inputs.numbers(q_way, "q_way", (len(times), 4), meaning="joint angles at each time")
    t = inputs.numbers(t, "t", ("m",))
    path = PchipInterpolator(times, q_way, axis=0)
    return path(t), path.derivative()(t)


def parts(table: Mapping[str, Part] | None = None) -> str:
    """Parts one a line, with call, meaning and lesson: those of `run`, or another table's."""
    lines = (
        f"{part.call}\n    {part.meaning}; lesson {part.lesson}"
        for part in (PARTS if table is None else table).values()
    )
    return "\n".join(lines)
