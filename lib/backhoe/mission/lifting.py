"""A tonne carried through the air: what the arm's gravity torque and inertia matrix are worth.

Nothing learns here: springs and dampers hold the arm to its way, and what drives it are torques
worked out from the model. What the model lacks the springs must supply, and a spring gives a torque
only when it is bent: the error is the model's. The base is fixed, and there is no soil.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from backhoe import simulation
from backhoe.arm import dynamics
from backhoe.basics.inputs import not_negative
from backhoe.machine import BACKHOE, Machine
from backhoe.machine.variants import loaded
from backhoe.mission.calls import call_part, given_parts
from backhoe.mission.parts import LIFT_PARTS
from backhoe.mission.records import Record, recorder_of
from backhoe.mission.table import table

SPRING, DAMPER = 1.2e6, 2.4e5
"""Of every joint [N m/rad, N m s/rad]."""

POSTURES = np.radians([[-90, 0, 30, 80], [-75, 40, -25, 20], [-90, 15, 40, 70]])
MOVE, REST, STILL = 2.2, 1.0, 0.3
"""Seconds from one posture to the next, at rest in it, and of these what counts as still."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LiftRun(Record):
    """The log of every step: `time` (n,) [s], `q`, `q_ref` (n, 4) [rad], `at_rest` (n,)."""

    load: float
    time: NDArray
    q: NDArray
    q_ref: NDArray
    at_rest: NDArray
    SHOWN = ("mission.lift", "A tonne in the air", "3D replay of the arm that carries a load")


@dataclass(frozen=True)
class LiftScore:
    """A load in the air in two numbers, beside the reference run.

    The root mean square of q_ref - q over the joints [rad]: `moving` on the way,
    `resting` in the postures between, where only weights are left.
    """

    moving: float
    resting: float
    swapped: tuple[str, ...] = ()
    reference: LiftScore | None = None

    def __str__(self) -> str:
        rows = [
            ("error on the way [deg]", "{:.3f}", lambda score: np.degrees(score.moving)),
            ("error at rest [deg]", "{:.3f}", lambda score: np.degrees(score.resting)),
        ]
        return table(self, rows)


def lift(
    *,
    gravity_torque: Callable | None = None,
    inertia_matrix: Callable | None = None,
    load: float = 1000.0,
    machine: Machine = BACKHOE,
    backend: str = "auto",
    record: bool = False,
    **unknown: object,
) -> LiftRun:
    """Carry a load up, over and down again on torques from a model, the library's or yours.

    The load's weight is known to both. The library's inertia matrix is that of the empty arm, as
    everywhere in the missions; yours is told the load.

    Args:
        gravity_torque, inertia_matrix: your parts; `LIFT_PARTS` gives the call of each.
        load: mass at the bucket's centre of mass [kg].
        machine: the empty machine.
        backend: as in `simulation.open_world`.
        record: keep what the 3D replay needs.

    Returns:
        The run, with its log.

    Raises:
        ValueError: a load below zero, or a part that returns a wrong shape or what is not finite.
        TypeError: a part of an unknown name, or one that cannot be called.
    """
    given = given_parts(
        LIFT_PARTS, unknown, gravity_torque=gravity_torque, inertia_matrix=inertia_matrix
    )
    load = not_negative(load, "load", "kg")
    full = loaded(load, machine)
    gravity, inertia = partial(dynamics.gravity_torque, machine=machine), None
    if "gravity_torque" in given:
        gravity = partial(call_part, "gravity_torque", gravity_torque, shape=(4,))
    if "inertia_matrix" in given:
        inertia = partial(call_part, "inertia_matrix", inertia_matrix, shape=(4, 4))
    time, q_ref, dq_ref, ddq_ref = _way(0.001)
    feed = dynamics.friction_torque(dq_ref, smoothing=0.01, machine=machine)
    q_log = np.empty_like(q_ref)
    with simulation.open_world(
        full, q=q_ref[0], base="fixed", soil=False, backend=backend
    ) as world:
        recorder = recorder_of(world) if record else None
        for step in range(len(time)):
            q, dq = world.q, world.dq
            q_log[step] = q
            if recorder is not None:
                recorder.capture()
            M = dynamics.mass_matrix(q, machine=machine) if inertia is None else inertia(q, load)
            torque = gravity(q) + M @ ddq_ref[step] + feed[step]
            torque += dynamics.gravity_torque(q, machine=full)
            torque -= dynamics.gravity_torque(q, machine=machine)
            torque += dynamics.coriolis_matrix(q, dq, machine=full) @ dq
            world.step(torque + SPRING * (q_ref[step] - q) + DAMPER * (dq_ref[step] - dq))
        backend = world.backend
    return LiftRun(
        swapped=tuple(given),
        machine=machine,
        backend=backend,
        recorder=recorder,
        load=load,
        time=time,
        q=q_log,
        q_ref=q_ref,
        at_rest=(time - 1e-9) % (MOVE + REST) > MOVE + REST - STILL,
    )


def scored(run: LiftRun) -> LiftScore:
    """The score of a run, beside the library's where a part was swapped in."""
    if not run.swapped:
        return _measure(run)
    return replace(_measure(run), reference=_reference(run.load, run.machine, run.backend))


@lru_cache(maxsize=4)
def _reference(load: float, machine: Machine, backend: str) -> LiftScore:
    return _measure(lift(load=load, machine=machine, backend=backend))


def _measure(run: LiftRun) -> LiftScore:
    off = (run.q_ref - run.q) ** 2
    moving, resting = (np.sqrt(off[some].mean()) for some in (~run.at_rest, run.at_rest))
    return LiftScore(moving=float(moving), resting=float(resting), swapped=run.swapped)


def _way(dt: float) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Times (n,) and angles, speeds, accelerations (n, 4) of the way, smooth at its ends."""
    legs = len(POSTURES) - 1
    time = dt * np.arange(round(legs * (MOVE + REST) / dt) + 1)
    leg = np.minimum((time / (MOVE + REST)).astype(int), legs - 1)
    s = np.minimum((time - leg * (MOVE + REST)) / MOVE, 1.0)[:, None]
    turn = np.diff(POSTURES, axis=0)[leg]
    q = POSTURES[leg] + turn * s**3 * (10 - 15 * s + 6 * s**2)
    dq = turn * 30 * s**2 * (1 - s) ** 2 / MOVE
    return time, q, dq, turn * 60 * s * (1 - s) * (1 - 2 * s) / MOVE**2
