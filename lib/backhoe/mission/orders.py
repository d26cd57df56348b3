"""Orders to the tracks that their drives cannot quite give: what a velocity controller makes of it.

A route at 0.4 m/s asks for six tenths of the drives at most, and there every controller that turns
the machine does well. These orders ask for more than the drives give, for a stop out of it, and
for the same backwards: who winds up, or lets the speed eat the turn, drives elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from backhoe.mission.calls import call_part, given_parts, reset
from backhoe.mission.parts import DRIVE_PARTS
from backhoe.mission.records import Record, recorder_of
from backhoe.mission.table import MARGIN_ROWS, table
from backhoe.simulation.standing import Least, Tipped
from backhoe.simulation.tracked_plant import TrackedPlant

ORDERS = ((6.0, 1.4, 0.3), (4.0, 0.0, 0.0), (4.0, -0.6, -0.3), (2.0, 0.0, 0.0))
"""For how long [s] which forward [m/s] and turning speed [rad/s], one after another: ours."""

STILL = 0.02, np.radians(1)
"""A machine stands below these speeds [m/s, rad/s]."""

_HEIGHT, _ORDERED, _LIBRARY = 0.03, (0.13, 0.35, 0.75, 1.0), (0.5, 0.5, 0.5, 1.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class OrderRun(Record):
    """What happened, a row for each sample of the controller.

    `time` (n,) [s]; `wanted` and `twist` (n, 2), forward and turning speed [m/s, rad/s], as ordered
    and after the sample; `pose` (n, 3) after it [m, m, rad]; `asked` and `traction` (n, 2), forces
    of the left and right track that the controller asked for and that the drives gave [N]; `least`
    margin of the balance.
    """

    time: NDArray
    wanted: NDArray
    twist: NDArray
    pose: NDArray
    asked: NDArray
    traction: NDArray
    least: Least
    SHOWN = ("mission.obey", "Orders to the tracks", "3D replay of the machine obeying orders")

    @property
    def ordered(self) -> NDArray:
        """Poses of a machine that obeys at once, shape (n, 3) [m, m, rad]."""
        dt = self.time[1] - self.time[0]
        turned = np.cumsum(self.wanted[:, 1]) * dt
        middle = turned - self.wanted[:, 1] * dt / 2
        way = np.cumsum(self.wanted[:, 0] * np.exp(1j * middle)) * dt
        return np.column_stack([way.real, way.imag, turned])

    def _drawn(self) -> dict[str, object]:
        from backhoe.view.replay.recording import Line

        ways = [(self.ordered, _ORDERED)]
        ways += [(_library(self.backend).pose, _LIBRARY)] if self.swapped else []
        flat = [(np.c_[pose[:, :2], np.full(len(pose), _HEIGHT)], hue) for pose, hue in ways]
        eye = np.array([9.0, -11.0, 8.0])
        return {"lines": tuple(Line(*way) for way in flat), "camera": (eye, np.array([4, 3, 0]))}


def obey(
    *,
    velocity_controller: Callable | None = None,
    backend: str = "auto",
    record: bool = False,
    **unknown: object,
) -> OrderRun:
    """Give the machine `ORDERS`, with the library's velocity controller or with yours.

    Args:
        velocity_controller: yours; `DRIVE_PARTS` gives its call.
        backend: as in `simulation.open_world`.
        record: keep what the 3D replay needs. It draws the ordered way blue and, of a run of
            yours, the library's grey.

    Returns:
        The run; `score` measures it.

    Raises:
        ValueError, TypeError: a part of the wrong name, or one that returns something else than two
            finite forces.
        Tipped: the machine tips over; its `run` has what happened until then.
    """
    parts = given_parts(DRIVE_PARTS, unknown, velocity_controller=velocity_controller)
    return _obey(parts, backend, record) if parts or record else _library(backend)


def _obey(parts: dict[str, Callable], backend: str, record: bool) -> OrderRun:
    asked, log, tipped = [], [], None
    with TrackedPlant(backend=backend) as plant:
        part = parts.get("velocity_controller", plant.controller)
        recorder = recorder_of(plant) if record else None
        reset(part)

        def controller(*state: float) -> tuple[float, float]:
            asked.append(call_part("velocity_controller", part, *state, shape=(2,)))
            return tuple(asked[-1])

        plant.controller = controller
        try:
            for seconds, *wanted in ORDERS:
                for _ in range(round(seconds / plant.dt)):
                    if recorder:
                        recorder.capture()
                    plant.step(*wanted)
                    log.append((plant.time, *wanted, *plant.twist, *plant.pose, *plant.traction))
        except Tipped as error:
            tipped = error
        time, wanted, twist, pose, traction = np.split(np.array(log), (1, 3, 5, 8), axis=1)
        run = OrderRun(
            swapped=tuple(parts),
            machine=plant.machine,
            backend=plant.backend,
            recorder=recorder,
            time=time[:, 0],
            wanted=wanted,
            twist=twist,
            pose=pose,
            asked=np.array(asked[: len(log)]),
            traction=traction,
            least=plant.world.least_margin,
        )
    if tipped:
        tipped.run = run
        raise tipped
    return run


@lru_cache(maxsize=2)
def _library(backend: str) -> OrderRun:
    return _obey({}, backend, record=False)


@dataclass(frozen=True)
class OrderScore:
    """Obedience in nine numbers, beside the library's.

    `speed` and `turn` the root mean squares of what the machine drove off its orders [m/s, rad/s],
    `heading` how far off it points at most [rad], `stands` the longest time from the order to stop
    until it does, or until the next order [s], `turns_on` the farthest that it turns meanwhile
    [rad], `push` the root mean square of the tracks' forces [N], `beyond` the share of samples in
    which more was asked for than the drives have [1], `margin` and `margin_time` as in `Score`.
    """

    speed: float
    turn: float
    heading: float
    stands: float
    turns_on: float
    push: float
    beyond: float
    margin: float
    margin_time: float
    swapped: tuple[str, ...] = ()
    reference: OrderScore | None = None

    def __str__(self) -> str:
        rows = [
            ("speed off [cm/s]", "{:.1f}", lambda score: 100 * score.speed),
            ("turn off [deg/s]", "{:.1f}", lambda score: np.degrees(score.turn)),
            ("heading off [deg]", "{:.0f}", lambda score: np.degrees(score.heading)),
            ("stands after [s]", "{:.1f}", lambda score: score.stands),
            ("turns on by [deg]", "{:.0f}", lambda score: np.degrees(score.turns_on)),
            ("force of a track [kN]", "{:.0f}", lambda score: score.push / 1e3),
            ("asks too much [%]", "{:.0f}", lambda score: 100 * score.beyond),
            *MARGIN_ROWS,
        ]
        return table(self, rows)


def scored(run: OrderRun) -> OrderScore:
    """Measure a run, beside the library's if a part of yours drove it.

    Args:
        run: what `obey` returned.
    """
    speed, turn = np.sqrt(np.mean((run.wanted - run.twist) ** 2, axis=0))
    stands, turns_on, first = 0.0, 0.0, 0
    dt = run.time[1] - run.time[0]
    for seconds, *wanted in ORDERS:
        rows = slice(first, first := first + round(seconds / dt))
        if not any(wanted) and rows.start < len(run.time):
            moving = (np.abs(run.twist[rows]) > STILL).any(axis=1)
            stands = max(stands, float(np.flatnonzero(np.r_[True, moving])[-1] * dt))
            turned = run.pose[rows, 2] - run.pose[rows.start - 1, 2]
            turns_on = max(turns_on, float(np.abs(turned).max()))
    most = run.machine.tracks.max_traction
    measured = OrderScore(
        speed=float(speed),
        turn=float(turn),
        heading=float(np.abs(run.ordered[:, 2] - run.pose[:, 2]).max()),
        stands=stands,
        turns_on=turns_on,
        push=float(np.sqrt(np.mean(run.traction**2))),
        beyond=float((np.abs(run.asked).max(axis=1) > 1.001 * most).mean()),
        margin=run.least.margin,
        margin_time=run.least.time,
        swapped=run.swapped,
    )
    return replace(measured, reference=scored(_library(run.backend))) if run.swapped else measured
