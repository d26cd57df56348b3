"""A load that nobody announced, and a rock that holds the bucket: what a controller is worth.

The arm holds a tonne of which the gravity torque knows nothing; then it swings and curls, and for
two seconds a rock keeps the bucket where it is. The joints' angles come in the steps of an encoder,
their speeds from gyroscopes. The base is fixed, and there is no soil.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from backhoe import simulation
from backhoe.arm import dynamics, pid
from backhoe.machine import BACKHOE, Machine
from backhoe.machine.variants import loaded
from backhoe.mission.calls import call_part, given_parts, reset
from backhoe.mission.parts import PARTS
from backhoe.mission.records import Record, recorder_of
from backhoe.mission.table import table

LOAD = 1000.0
"""Of which nothing is said [kg]."""

START, TURN = np.radians([[-100, 15, 30, 30], [40, 10, -10, 50]])
"""Joint angles while the arm holds still, and how far they turn then [rad]."""

MOVE, ROCK, END = (4.0, 8.0), (5.5, 7.5), 14.0
"""When the joints turn, when the rock is there, and when all ends [s]."""

STEP = 2 * np.pi / 2**17
"""Of the encoders [rad]."""

_SPRING, _DAMPER = 4e6, 4e4
_CAME_HOME, _STILL = np.radians(1.0), 0.5


@dataclass(frozen=True, eq=False, kw_only=True)
class HoldRun(Record):
    """The log of every step: `time` (n,) [s]; `q`, `q_ref` (n, 4) [rad]; `torque` (n, 4) [N m].

    `torque` is what the controller and the empty arm's gravity torque asked for. A machine that ran
    away leaves NaN from there on.
    """

    time: NDArray
    q: NDArray
    q_ref: NDArray
    torque: NDArray
    SHOWN = (
        "mission.hold",
        "A load, a swing, a rock",
        "3D replay of the arm that holds a load, swings, and is held back by a rock for 2 s",
    )


@dataclass(frozen=True)
class HoldScore:
    """A run in five numbers, beside the library's.

    `load` the largest error of a joint after 4 s under the load, `swing` the root mean square of
    the errors of swing, boom and stick while they turn [rad]; `overshoot` how far the bucket goes
    beyond its goal after the rock [rad], `home` when it is within 1 degree for good, after the rock
    [s], infinite if it never is; `jumps` the root mean square of what a torque changes by from one
    sample to the next, over its limit, of the joint with the most. NaN where a machine that ran
    away did not get.
    """

    load: float
    swing: float
    overshoot: float
    home: float
    jumps: float
    swapped: tuple[str, ...] = ()
    reference: HoldScore | None = None

    def __str__(self) -> str:
        rows = [
            ("off under the load [deg]", "{:.2f}", lambda score: np.degrees(score.load)),
            ("off in the swing [deg]", "{:.2f}", lambda score: np.degrees(score.swing)),
            ("beyond the goal [deg]", "{:.1f}", lambda score: np.degrees(score.overshoot)),
            ("home after the rock [s]", "{:.1f}", lambda score: score.home),
            ("torque jumps [%]", "{:.1f}", lambda score: 100 * score.jumps),
        ]
        return table(self, rows)


def hold(
    *,
    controller: Callable | None = None,
    machine: Machine = BACKHOE,
    backend: str = "auto",
    record: bool = False,
    **unknown: object,
) -> HoldRun:
    """Hold an unknown load, swing, and be held back by a rock, with the library's PID or yours.

    Args:
        controller: your part; `PARTS` gives its call. The gravity torque of the empty arm is added
            to its torque, which is cut at the drives' limits.
        machine: the empty machine.
        backend: as in `simulation.open_world`.
        record: keep what the 3D replay needs.

    Returns:
        The run, with its log; `score` makes five numbers of it.

    Raises:
        ValueError: the controller returns a wrong shape or what is not finite.
        TypeError: a part of an unknown name, or one that cannot be called.
    """
    given = given_parts({"controller": PARTS["controller"]}, unknown, controller=controller)
    reset(controller)
    law = pid.PID(*pid.ARM_GAINS, machine.torque_limit)
    if given:
        law = partial(call_part, "controller", controller, shape=(4,))
    time = 1e-3 * np.arange(round(1000 * END) + 1)
    q_ref, dq_ref = _way(time)
    log, limit = np.full((2, len(time), 4), np.nan), machine.torque_limit
    with simulation.open_world(
        loaded(LOAD, machine), q=q_ref[0], base="fixed", soil=False, backend=backend
    ) as world:
        recorder = recorder_of(world) if record else None
        for step, now in enumerate(time):
            q, dq = world.q, world.dq
            seen = STEP * np.round(q / STEP)
            if recorder is not None:
                recorder.capture()
            torque = law(q_ref[step], dq_ref[step], seen, dq, world.dt)
            torque = torque + dynamics.gravity_torque(q, machine)
            log[:, step] = q, torque
            given_torque = np.clip(torque, -limit, limit)
            if ROCK[0] <= now < ROCK[1]:
                held = log[0, round(1000 * ROCK[0]), 3]
                given_torque[3] -= _SPRING * (q[3] - held) + _DAMPER * dq[3]
            try:
                world.step(given_torque)
            except RuntimeError:
                break
        backend = world.backend
    return HoldRun(
        swapped=tuple(given),
        machine=machine,
        backend=backend,
        recorder=recorder,
        time=time,
        q=log[0],
        q_ref=q_ref,
        torque=log[1],
    )


def measure(run: HoldRun) -> HoldScore:
    """Five numbers of a run, the library's beside them if a part of yours was in it."""
    time, error = run.time, np.abs(run.q_ref - run.q)
    before, turning = time < MOVE[0], (time >= MOVE[0]) & (time < MOVE[1])
    after = time >= ROCK[1]
    late = before & (time >= MOVE[0] - _STILL)
    away = time[after][~(error[after, 3] < _CAME_HOME)]
    home = away[-1] - ROCK[1] if len(away) else 0.0
    quiet = (time < ROCK[0]) | (time >= MOVE[1])
    jumps = np.diff(run.torque, axis=0)[quiet[1:]] / run.machine.torque_limit
    beyond = (run.q - run.q_ref[-1])[after, 3] * np.sign(TURN[3])
    made = HoldScore(
        load=float(error[late].mean(axis=0).max()),
        swing=float(np.sqrt(np.mean(error[turning][:, :3] ** 2))),
        overshoot=float(np.maximum(beyond.max(), 0.0)),
        home=float(np.inf if home > END - ROCK[1] - _STILL else home),
        jumps=float(np.sqrt(np.mean(jumps**2, axis=0)).max()),
        swapped=run.swapped,
    )
    return replace(made, reference=_library(run.machine, run.backend)) if run.swapped else made


@lru_cache(maxsize=4)
def _library(machine: Machine, backend: str) -> HoldScore:
    return measure(hold(machine=machine, backend=backend))


def _way(time: NDArray) -> tuple[NDArray, NDArray]:
    """Angles and speeds at these times [s], smooth where the joints begin and end to turn."""
    s = np.clip((time - MOVE[0]) / (MOVE[1] - MOVE[0]), 0.0, 1.0)[:, None]
    q = START + TURN * s**3 * (10 - 15 * s + 6 * s**2)
    return q, TURN * 30 * s**2 * (1 - s) ** 2 / (MOVE[1] - MOVE[0])
