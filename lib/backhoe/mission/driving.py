"""Driving the machine along a path with the library's parts, or with a student's.

The tracker looks at where the machine is and says how fast to drive; the velocity controller makes
forces of that. Where the machine is they are told truly, unless an odometry or a localisation is
given: then the machine drives on what that makes of its sensors (`estimation`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, positive, whole
from backhoe.machine import BACKHOE, Machine
from backhoe.mission.calls import ESTIMATORS, call_part, given_parts, reset
from backhoe.mission.estimation import EstimatedPlant
from backhoe.mission.parts import DRIVE_PARTS
from backhoe.mission.records import Record, recorder_of
from backhoe.mission.route import SPEED, default_route
from backhoe.simulation.standing import Least
from backhoe.simulation.tracked_plant import TrackedPlant
from backhoe.vehicle.tracking import (
    ARRIVAL,
    Assessment,
    Follow,
    Goal,
    Path,
    PurePursuit,
    assess,
    follow,
)
from backhoe.vehicle.tracking.follow import tracker_name

if TYPE_CHECKING:
    from backhoe.view.replay.recording import Line

LOOKAHEAD = 0.6
"""Of the library's tracker, pure pursuit [m]: ours, for this machine."""

_PATH_COLOUR = (0.13, 0.35, 0.75, 1.0)
_BELIEF_COLOUR = (0.9, 0.62, 0.0, 1.0)
_ELLIPSE_EVERY = 100  # samples


@dataclass(frozen=True, eq=False, kw_only=True)
class DriveRun(Follow, Record):
    """What happened, one row for each sample and one for the end: a `tracking.Follow`, and more.

    `traction` (n, 2), the forces of the left and right track until that time [N], None for a plant
    without tracks; `margin` (n,) of its balance [m] and the `least` since the plant's start, None
    as well; `own_plant`, `fixes` [s], `seed`, `time_limit` [s] as `drive` was told. All of
    that and the `pose` is the truth. Where the machine took itself to be is in `estimates`, (n, 3)
    [m, m, rad] by the estimator's name; empty if it was told the truth. `claims` (n, 3, 3) is what
    a localisation with an attribute `P` said of the pose's error, NaN without, and `surprises`
    (fixes,) the NIS of each fix by that [1]. `long_steps` is how far an odometry's places move when
    it is asked every 0.3 to 0.8 s only, root mean square [m]; NaN without one.
    """

    traction: NDArray | None
    margin: NDArray | None
    least: Least | None
    estimates: dict[str, NDArray]
    claims: NDArray
    surprises: NDArray
    long_steps: float
    own_plant: bool
    fixes: float | None
    seed: int
    time_limit: float | None
    SHOWN = ("mission.drive", "Drive a route", "3D replay of the machine driving along a path")

    @cached_property
    def assessment(self) -> Assessment:
        """Metrics, time error and effort; see `tracking.assess`."""
        return assess(self)

    @property
    def estimate(self) -> NDArray | None:
        """Poses that the tracker was told in place of the truth, shape (n, 3) [m, m, rad]."""
        return next(reversed(self.estimates.values()), None)

    def _drawn(self) -> dict[str, object]:
        from backhoe.view.replay.recording import Line

        points, believed = self.path.points, self.estimate
        lines = [Line(np.column_stack([points, np.full(len(points), 0.03)]), _PATH_COLOUR)]
        camera = _overview(np.vstack([points, self.pose[:, :2]]), self.machine)
        if believed is None:
            return {"lines": tuple(lines), "camera": camera}
        flat = np.column_stack([believed[:, :2], np.full(len(believed), 0.06)])
        lines += [Line(flat, _BELIEF_COLOUR), *_ellipses(self)]
        return {"lines": tuple(lines), "camera": camera, "belief": (self.time, believed)}


def _ellipses(run: DriveRun) -> list[Line]:
    """Where the localisation claims to be, to 95 %, every two seconds; none without claims."""
    from backhoe.localisation.kalman import ellipse
    from backhoe.view.replay.recording import Line

    found = []
    for k in range(_ELLIPSE_EVERY, len(run.pose), _ELLIPSE_EVERY):
        P = (run.claims[k, :2, :2] + run.claims[k, :2, :2].T) / 2
        if np.isfinite(P).all() and np.linalg.eigvalsh(P).min() >= 0:
            outline = ellipse(run.estimate[k, :2], P)
            rim = np.column_stack([outline, np.full(len(outline), 0.06)])
            found.append(Line(rim, _BELIEF_COLOUR))
    return found


class Watched:
    """A plant with `seen`, a list of what `look(plant)` gave at first and after each sample."""

    def __init__(self, plant: object, look: Callable[[object], object]) -> None:
        self._plant, self._look = plant, look
        self.seen = [look(plant)]

    def __getattr__(self, name: str) -> object:
        return getattr(self._plant, name)

    def step(self, v: float, omega: float) -> None:
        """One sample with wanted forward and turning speed [m/s, rad/s]."""
        self._plant.step(v, omega)
        self.seen.append(self._look(self._plant))


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
            the path has no times for, estimators for a plant without tracks, or a pose, machine,
            backend or velocity_controller beside a plant of your own.
        TypeError: a part of an unknown name, or one that cannot be called, or a path that is none.
    """
    parts = given_parts(
        DRIVE_PARTS,
        unknown,
        velocity_controller=velocity_controller,
        tracker=tracker,
        odometry=odometry,
        localisation=localisation,
    )
    if fixes is not None and localisation is None:
        raise ValueError("fixes are for a localisation: odometry would not look at them")
    fixes = None if fixes is None else positive(fixes, "fixes", "s")
    seed = whole(seed, "seed", least=0)
    path = default_route() if path is None else path
    instance(path, "path", Path, "make one, from_points(...)")
    mode = ("path" if path.times is None else "trajectory") if mode is None else mode
    others = machine is not BACKHOE or backend != "auto" or pose is not None
    if plant is not None and (others or velocity_controller is not None):
        raise ValueError(
            "velocity_controller, machine, backend and pose are for the plant that drive opens:"
            " a plant of your own brings them, as in simulation.TrackedPlant(controller=...)"
        )
    kept = {"own_plant": plant is not None, "fixes": fixes, "seed": seed, "time_limit": time_limit}
    if plant is not None:
        return _drive(plant, parts, path, mode, record, kept)
    controller = _controller(velocity_controller)
    with TrackedPlant(machine=machine, backend=backend, pose=pose, controller=controller) as opened:
        return _drive(opened, parts, path, mode, record, kept)


def _drive(
    plant: object, parts: dict, path: Path, mode: str, record: bool, kept: dict[str, object]
) -> DriveRun:
    recorder = recorder_of(plant) if record else None
    estimators = {name: parts[name] for name in ESTIMATORS if name in parts}
    if estimators and not (hasattr(plant, "belts") and hasattr(plant, "machine")):
        raise ValueError(
            f"{' and '.join(estimators)} need encoders on tracks: drive the machine, not a "
            f"{type(plant).__name__}"
        )

    world = getattr(plant, "world", None)

    def look(plant: object) -> tuple[NDArray, NDArray | None, float | None]:
        if recorder is not None:
            recorder.capture()
        return (
            np.array(plant.pose),
            getattr(plant, "traction", None),
            getattr(world, "margin", None),
        )

    driven = watched = Watched(plant, look)
    if estimators:
        driven = EstimatedPlant(watched, estimators, kept["fixes"], kept["seed"])
    tracker, name = PurePursuit(lookahead=LOOKAHEAD), None
    if "tracker" in parts:
        tracker, name = _CheckedTracker(parts["tracker"]), tracker_name(parts["tracker"])
    limit = kept["time_limit"]
    run = follow(tracker, driven, path, mode=mode, time_limit=limit, speed=SPEED, name=name)
    truth, traction, margin = zip(*watched.seen, strict=True)
    if estimators:
        run = _as_it_was(run, np.array(truth))
    estimates = driven.estimates if estimators else {}
    return DriveRun(
        **{field.name: getattr(run, field.name) for field in fields(Follow)},
        swapped=tuple(name for name, part in parts.items() if not isinstance(part, str)),
        machine=getattr(plant, "machine", None),
        backend=getattr(plant, "backend", "own"),
        recorder=recorder,
        traction=None if traction[0] is None else np.array(traction),
        margin=None if margin[0] is None else np.array(margin),
        least=getattr(world, "least_margin", None),
        long_steps=driven.in_long_steps() if "odometry" in estimators else np.nan,
        estimates={name: np.array(poses) for name, poses in estimates.items()},
        claims=np.array(driven.claims if estimators else np.empty((0, 3, 3))),
        surprises=np.array(driven.surprises if estimators else []),
        **kept,
    )


def _as_it_was(run: Follow, truth: NDArray) -> Follow:
    """The run with the true poses; who takes itself to have arrived must be there."""
    close = float(np.hypot(*(truth[-1, :2] - run.path.points[-1]))) <= ARRIVAL
    return replace(run, pose=truth, reached=close and (run.reached or run.mode == "trajectory"))


class _CheckedTracker:
    """A student's tracker: it gets copies, but for the read-only path; its errors name it."""

    def __init__(self, tracker: Callable) -> None:
        self._tracker, self.period = tracker, getattr(tracker, "period", None)

    def reset(self) -> None:
        reset(self._tracker)

    def __call__(self, pose: NDArray, twist: NDArray, goal: Goal, dt: float) -> NDArray:
        places = goal.position.copy(), goal.next_position.copy()
        goal = goal._replace(position=places[0], next_position=places[1])
        return call_part("tracker", self._tracker, pose, twist, goal, dt, shape=(2,))


def _controller(part: Callable | None) -> Callable | None:
    """A student's velocity controller with its answers and errors named."""
    if part is None:
        return None
    reset(part)
    return partial(call_part, "velocity_controller", part, shape=(2,))


def _overview(points: NDArray, machine: Machine | None) -> tuple[NDArray, NDArray]:
    """Eye and target of a camera that sees all points and what drives there, (3,) each [m]."""
    low, high = points.min(axis=0), points.max(axis=0)
    size = float(np.hypot(*(high - low))) + (1.0 if machine is None else 8.0)
    target = np.append((low + high) / 2, 0.05 * size)
    return target + size * np.array([0.55, -0.7, 0.5]), target
