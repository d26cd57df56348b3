"""Driving the machine along a path with the library's parts, or with a student's.

The tracker looks at where the machine is and says how fast to drive; the velocity controller makes
forces of that. Where the machine is they are told truly, unless an odometry or a localisation is
given: then the machine drives on what that makes of its sensors (`believing`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import positive
from backhoe.machine import BACKHOE, Machine
from backhoe.mission.asking import asked, checked_part, numbers
from backhoe.mission.believing import LIBRARY, Believing, checked_estimators
from backhoe.mission.parts import DRIVE_PARTS
from backhoe.mission.route import SPEED, default_route
from backhoe.simulation.tracked_plant import TrackedPlant
from backhoe.vehicle.tracking import (
    ARRIVAL,
    Assessment,
    Follow,
    Metrics,
    Path,
    PurePursuit,
    assess,
    follow,
)
from backhoe.vehicle.tracking.follow import tracker_name

if TYPE_CHECKING:
    from backhoe.view.replay import Recorder, Replay

LOOKAHEAD = 0.6
"""Of the library's tracker, pure pursuit [m]: ours, for this machine."""

_PATH_COLOUR = (0.13, 0.35, 0.75, 1.0)


@dataclass(eq=False)
class DriveRun:
    """What happened, one row for each sample and one for the end.

    `time` (n,) [s]; `pose` (n, 3) = x, y, heading [m, m, rad]; `reference` (n, 2), the goal's
    position [m]; `twist` (n, 2) measured and `command` (n, 2) wanted [m/s, rad/s]; `traction`
    (n, 2), the forces of the left and right track until that time [N], None for a plant without
    tracks; `metrics` and `assessment` as in `tracking`; `reached` whether it arrived; `swapped`
    names the student's parts; `path`, `mode`, `machine`, `backend`, `dt` and `pose[0]` say what was
    driven. All of that is the truth. What the machine believed is `estimate` (n, 3), and by its
    estimators' names `beliefs`; None and empty if it was told the truth. `fixes` [s] and `seed` are
    those of its sensors.
    """

    swapped: tuple[str, ...]
    path: Path
    mode: str
    time: NDArray
    pose: NDArray
    reference: NDArray
    twist: NDArray
    command: NDArray
    traction: NDArray | None
    metrics: Metrics
    assessment: Assessment
    reached: bool
    dt: float
    machine: Machine | None
    backend: str
    own_plant: bool
    recorder: Recorder | None = field(default=None, repr=False)
    estimate: NDArray | None = None
    beliefs: dict[str, NDArray] = field(default_factory=dict)
    fixes: float | None = None
    seed: int = 0
    time_limit: float | None = None

    def replay(
        self,
        title: str = "Drive a route",
        alt: str = "3D replay of the machine driving along a path",
    ) -> Replay:
        """The run as a 3D replay for the notebook, with the path drawn on the ground.

        Args:
            title: what stands above it.
            alt: what it shows, for readers who do not see it.

        Raises:
            ValueError: the run was not recorded, or title or alt is empty.
        """
        from backhoe.view.replay.recording import Line

        if self.recorder is None:
            raise ValueError("this run was not recorded: call mission.drive(record=True)")
        points = np.column_stack([self.path.points, np.full(len(self.path.points), 0.03)])
        return self.recorder.replay(
            title=title,
            alt=alt,
            lines=(Line(points, _PATH_COLOUR),),
            camera=_overview(np.vstack([self.path.points, self.pose[:, :2]]), self.machine),
        )


def drive(
    *,
    path: Path | None = None,
    tracker: Callable | None = None,
    velocity_controller: Callable | None = None,
    odometry: Callable | str | None = None,
    localisation: Callable | str | None = None,
    fixes: float | None = None,
    seed: int = 0,
    mode: str | None = None,
    plant: object | None = None,
    machine: Machine = BACKHOE,
    backend: str = "auto",
    pose: ArrayLike | None = None,
    time_limit: float | None = None,
    record: bool = False,
    **unknown: object,
) -> DriveRun:
    """Drive along a path with the library's parts, or with yours in their place.

    Args:
        path: where to drive; default `default_route`, a G of about a minute.
        tracker, velocity_controller: your parts; `DRIVE_PARTS` gives the call of each. What is left
            out is the library's: pure pursuit and `travel.VelocityPI`.
        odometry, localisation: what tells the tracker where the machine is, your part or "library"
            for the library's; default the truth. Of both, the localisation counts, and the odometry
            runs beside it.
        fixes: time between two positions by a total station, for the localisation [s].
        seed: of the noise of encoders, gyro and fixes; their variances are `drives.NOISE`.
        mode: "path" or "trajectory" as in `tracking.follow`; default trajectory if the path has
            times.
        plant: what is driven, a rover or `skid_steer.SkidSteerPlant`; default the machine on its
            tracks. It is driven from where it stands and left open.
        machine, backend: of the machine on its tracks, as in `simulation.open_world`.
        pose: where that machine starts, x, y, heading, shape (3,) [m, m, rad]; default the origin.
        time_limit: end of the run at the latest [s].
        record: keep what the 3D replay needs.

    Returns:
        The run, with its log.

    Raises:
        ValueError: a part that returns the wrong shape or values that are not finite, a mode that
            the path has no times for, or a pose, machine, backend or velocity_controller beside a
            plant of your own.
        TypeError: a part of an unknown name, or one that cannot be called, or a path that is none.
    """
    if unknown:
        names = ", ".join(DRIVE_PARTS)
        raise TypeError(f"unknown part {next(iter(unknown))!r}: the parts are {names}")
    offered = {"velocity_controller": velocity_controller, "tracker": tracker}
    given = {name: part for name, part in offered.items() if part is not None}
    for name, part in given.items():
        checked_part(name, part)
    believers = checked_estimators({"odometry": odometry, "localisation": localisation})
    _check_fixes(fixes, localisation)
    path = default_route() if path is None else path
    if not isinstance(path, Path):
        raise TypeError(f"path must be a tracking.Path, got {path!r}: make one, from_points(...)")
    mode = ("path" if path.times is None else "trajectory") if mode is None else mode
    senses = believers, fixes, seed
    settings = path, mode, given, senses, time_limit, record
    if plant is not None:
        others = machine is not BACKHOE or backend != "auto" or pose is not None
        if velocity_controller is not None or others:
            raise ValueError(
                "velocity_controller, machine, backend and pose are for the plant that drive opens:"
                " a plant of your own brings them, as in simulation.TrackedPlant(controller=...)"
            )
        return _drive(plant, *settings, own_plant=True)
    controller = _checked_controller(velocity_controller)
    with TrackedPlant(machine=machine, backend=backend, pose=pose, controller=controller) as opened:
        return _drive(opened, *settings, own_plant=False)


def _drive(
    plant: object,
    path: Path,
    mode: str,
    given: dict[str, Callable],
    senses: tuple[dict[str, object], float | None, int],
    time_limit: float | None,
    record: bool,
    own_plant: bool,
) -> DriveRun:
    believers, fixes, seed = senses
    recorder = _recorder(plant) if record else None
    believing = Believing(plant, believers, fixes, seed) if believers else None
    watched = _Watched(plant if believing is None else believing, recorder)
    own = given.get("tracker")
    tracker = PurePursuit(lookahead=LOOKAHEAD) if own is None else _CheckedTracker(own)
    name = None if own is None else tracker_name(own)
    run = follow(tracker, watched, path, mode=mode, time_limit=time_limit, speed=SPEED, name=name)
    believed = None if believing is None else run.pose
    if believing is not None:
        run = _as_it_was(run, np.array(believing.truth))
    assessment = assess(run)
    swapped = (*given, *(name for name, part in believers.items() if part != LIBRARY))
    return DriveRun(
        swapped=swapped,
        path=path,
        mode=mode,
        time=run.time,
        pose=run.pose,
        reference=run.goal,
        twist=run.twist,
        command=run.command,
        traction=watched.traction,
        metrics=run.metrics,
        assessment=assessment,
        reached=run.reached,
        dt=watched.dt,
        machine=getattr(plant, "machine", None),
        backend=getattr(plant, "backend", "own"),
        own_plant=own_plant,
        recorder=watched.recorder,
        estimate=believed,
        beliefs={} if believing is None else _arrays(believing.beliefs),
        fixes=fixes,
        seed=seed,
        time_limit=time_limit,
    )


def _as_it_was(run: Follow, truth: NDArray) -> Follow:
    """The run with the true poses; who believes to have arrived must be there."""
    close = float(np.hypot(*(truth[-1, :2] - run.path.points[-1]))) <= ARRIVAL
    arrived = close and (run.reached or run.mode == "trajectory")
    return replace(run, pose=truth, reached=arrived)


def _arrays(beliefs: dict[str, list[NDArray]]) -> dict[str, NDArray]:
    return {name: np.array(poses) for name, poses in beliefs.items()}


def _check_fixes(fixes: float | None, localisation: object) -> None:
    if fixes is None:
        return
    if localisation is None:
        raise ValueError("fixes are for a localisation: odometry would not look at them")
    positive(fixes, "fixes", "s")


class _Watched:
    """A plant whose tractions are logged and whose frames are kept."""

    def __init__(self, plant: object, recorder: Recorder | None) -> None:
        self._plant, self.recorder, self.dt = plant, recorder, plant.dt
        self._traction = [self._now()]
        limits = getattr(plant, "limits", None)
        if limits is not None:
            self.limits = limits
        self._capture()

    @property
    def pose(self) -> NDArray:
        return self._plant.pose

    @property
    def twist(self) -> NDArray:
        return self._plant.twist

    @property
    def time(self) -> float:
        return self._plant.time

    @property
    def traction(self) -> NDArray | None:
        return None if self._traction[0] is None else np.array(self._traction)

    def step(self, v: float, omega: float) -> None:
        self._plant.step(v, omega)
        self._traction.append(self._now())
        self._capture()

    def _now(self) -> NDArray | None:
        return getattr(self._plant, "traction", None)

    def _capture(self) -> None:
        if self.recorder is not None:
            self.recorder.capture()


class _CheckedTracker:
    """A student's tracker: it gets copies, but for the read-only path; its errors name it."""

    def __init__(self, tracker: Callable) -> None:
        self._tracker, self.period = tracker, getattr(tracker, "period", None)

    def reset(self) -> None:
        if callable(getattr(self._tracker, "reset", None)):
            self._tracker.reset()

    def __call__(self, pose: NDArray, twist: NDArray, goal: object, dt: float) -> NDArray:
        places = goal.position.copy(), goal.next_position.copy()
        goal = goal._replace(position=places[0], next_position=places[1])
        answer = asked("tracker", self._tracker, pose, twist, goal, dt)
        return numbers("tracker", "your tracker", answer, (2,))


def _overview(points: NDArray, machine: Machine | None) -> tuple[NDArray, NDArray]:
    """Eye and target of a camera that sees all points and what drives there, (3,) each [m]."""
    low, high = points.min(axis=0), points.max(axis=0)
    size = float(np.hypot(*(high - low))) + (1.0 if machine is None else 8.0)
    target = np.append((low + high) / 2, 0.05 * size)
    return target + size * np.array([0.55, -0.7, 0.5]), target


def _checked_controller(part: Callable | None) -> Callable | None:
    """A student's velocity controller with its answers and errors named."""
    if part is None:
        return None
    if callable(getattr(part, "reset", None)):
        part.reset()

    def controller(*speeds: float) -> NDArray:
        answer = asked("velocity_controller", part, *speeds)
        return numbers("velocity_controller", "your velocity_controller", answer, (2,))

    return controller


def _recorder(plant: object) -> Recorder:
    from backhoe.view.replay import Recorder

    seen = getattr(plant, "world", plant)
    if not (hasattr(seen, "machine") or hasattr(seen, "wheel_angles")):
        raise ValueError(
            "record=True needs something to look at: the machine on its tracks or a rover of "
            f"simulation.open_rover, got {type(plant).__name__}"
        )
    return Recorder(seen)
