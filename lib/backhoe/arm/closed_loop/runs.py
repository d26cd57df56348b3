"""A batch of closed-loop simulations of the arm."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics
from backhoe.arm.closed_loop.arguments import LAWS, RATES, Task, prepared
from backhoe.arm.closed_loop.batch import Batch, Trajectory
from backhoe.arm.closed_loop.rows import LANES
from backhoe.arm.dynamics.terms import Arm, arm_of
from backhoe.arm.movement import Movement
from backhoe.basics.tiles import cores
from backhoe.machine import BACKHOE, Machine

COULOMB_SMOOTHING = 0.01
"""Speed below which Coulomb friction passes smoothly through zero [rad/s], as in `sim`."""

LARGEST_ERROR = pi
"""A run whose joint is half a turn away from its reference has diverged [rad]."""

LARGEST_SPEED = 50.0
"""A run with a joint as fast as this has diverged [rad/s]."""

_MOBILITY_EVERY = 50


def simulate(
    gains: Sequence[ArrayLike],
    movement: Movement,
    *,
    machine: Machine = BACKHOE,
    model: Machine | None = None,
    law: str = "pid",
    friction: bool = True,
    torque_limit: ArrayLike | None = None,
    payload: ArrayLike = 0.0,
    q0: ArrayLike | None = None,
    settled: bool = False,
    state_every: int = 1,
    rate: str = "measured",
    filter_time: float = 0.0,
    record: Iterable[int] | str = (),
    record_every: int = 1,
    threads: int | None = None,
) -> Batch:
    """Let the arm follow a movement under PID control, once for each set of gains.

    In each sample of the movement the law gives a torque, which is held until the next:

    | law | torque, before the limit |
    |---|---|
    | "pid" | K_p e + K_i xi + K_d de |
    | "pid+gravity" | g(q) + K_p e + K_i xi + K_d de |
    | "computed_torque" | M(q) (ddq_ref + K_p e + K_i xi + K_d de) + C(q, dq) dq + g(q) |

    with e = q_ref - q and xi the sum of e dt, this sample included. A joint's sum stands still in a
    sample whose torque is at the limit and has the sign of e, as in `pid.PID`, whose numbers "pid"
    reproduces. With friction, viscous friction and a smoothed Coulomb friction act as in `sim`. The
    stops at the ends of the joints' ranges are not modelled; `Batch.overrun` tells of them.

    Source: Mastalli 2013, eqs. (3.1), (3.2) and (3.28).

    Args:
        gains: kp, ki, kd (a `pid.Gains` will do), each of shape (n, 4), or (4,) for one run
            [N m/rad, N m/(rad s), N m s/rad; 1/s^2, 1/s^3, 1/s for "computed_torque"].
        movement: the reference; its dt is the sampling time.
        machine: the arm that moves, its bucket empty; `BACKHOE` unless told.
        model: the arm that the law believes in; `machine` unless told.
        law: one of `LAWS`, "pid" unless told.
        friction: whether the joints have friction, True unless told.
        torque_limit: largest torques, shape (4,) [N m]; None, as unless told, for no limit.
        payload: point mass at the bucket's centre of mass, a float or shape (n,), 0 unless told
            [kg]. The law's model knows nothing of it.
        q0: joint angles at the start, shape (4,) or (n, 4) [rad]; those of the movement unless
            told. The arm starts with the movement's speed.
        settled: whether the integral starts at K_i xi = g(q0), payload included and less what the
            law adds itself, as if the arm had been held there for long; False unless told.
        state_every: samples from one reading of the joints to the next: 10 for a state at 100 Hz
            in a loop at 1 kHz; 1 unless told.
        rate: what the derivative is of: "measured" joint speeds, as unless told, or the
            "difference" of the error from sample to sample, as (3.28) prints it.
        filter_time: time constant of the difference's filter [s], 0 unless told: the "backward"
            form of `pid.DigitalPID`.
        record: indices of the runs to keep whole, or "all"; none unless told.
        record_every: keep every which sample of those, 1 unless told.
        threads: 1 for the caller's alone; None for one on each core.

    Returns:
        Measures of the n runs, and the recorded ones. A run with an error of `LARGEST_ERROR` or a
        joint as fast as `LARGEST_SPEED` is stopped and marked as diverged.

    Raises:
        ValueError: an array of another shape, a value that is not finite, negative gains or
            payload, an unknown law, settled with a K_i that cannot hold the arm.
        TypeError: movement is no Movement.
    """
    options = locals()
    del options["threads"]
    if not (threads is None or (isinstance(threads, int | np.integer) and threads >= 1)):
        raise ValueError(f"threads must be a whole number, 1 or more, or None, got {threads!r}")
    return carry_out(prepared(**options), threads)


def carry_out(task: Task, threads: int | None = None) -> Batch:
    """Simulate all runs of a task."""
    from backhoe.arm.closed_loop import kernels

    movement, count = task.movement, len(task.gains)
    samples = len(movement)
    reference = np.stack([movement.q, movement.dq, movement.ddq])
    arm, model = (Arm(*map(float, arm_of(m))) for m in (task.machine, task.model))
    numbers, rates = _numbers(task), _settling_rates(task)
    sampling = (
        movement.dt,
        task.state_every,
        RATES.index(task.rate),
        task.filter_time,
        LARGEST_ERROR,
        LARGEST_SPEED,
    )
    measures, taken = np.zeros((count, 7, 4)), np.zeros(count, dtype=int)
    rows = -(-samples // task.record_every)
    logs = np.empty((len(task.record), rows, 3, 4))
    log_of = np.full(count, -1)
    log_of[list(task.record)] = np.arange(len(task.record))
    own = np.zeros((count, 7, 4))
    own[:, :3], own[:, 3:6], own[:, 6, 0] = task.gains, task.start, task.payload

    def run_block(block: slice) -> None:
        taken[block] = kernels.run(
            arm,
            numbers,
            model,
            LAWS.index(task.law),
            own[block],
            reference,
            rates,
            sampling,
            task.record_every,
            log_of[block],
            logs,
            measures[block],
        )

    threads = cores() if threads is None else threads
    blocks = _blocks(count, LANES, threads)
    if threads == 1 or len(blocks) == 1:
        for block in blocks:
            run_block(block)
    else:
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(run_block, blocks))
    return _batch(task, measures, taken, dict(zip(task.record, logs, strict=True)))


def _blocks(count: int, most: int, threads: int) -> list[slice]:
    """Blocks of about one size, at most `most` runs each, a whole number of them for each thread.

    With fewer runs than threads some threads have none.
    """
    rounds = -(-count // (most * threads))
    size = -(-count // (rounds * threads))
    return [slice(first, min(first + size, count)) for first in range(0, count, size)]


def _numbers(task: Task) -> NDArray:
    """Friction, limits and smoothing as `kernels.run` reads them, shape (6, 4)."""
    machine = task.machine
    return np.stack(
        [
            machine.viscous * task.friction,
            machine.coulomb * task.friction,
            task.torque_limit,
            machine.lower,
            machine.upper,
            np.full(4, COULOMB_SMOOTHING),
        ]
    )


def _settling_rates(task: Task) -> NDArray:
    """Rate at which smoothed Coulomb friction settles a slow speed, shape (n, 4) [1/s].

    It is the friction over the smoothing speed, times the joint's mobility at the reference.
    """
    M = dynamics.mass_matrix(task.movement.q[::_MOBILITY_EVERY], task.machine)
    mobility = np.diagonal(np.linalg.inv(M), axis1=-2, axis2=-1)
    slope = task.friction * task.machine.coulomb / COULOMB_SMOOTHING
    return np.repeat(slope * mobility, _MOBILITY_EVERY, axis=0)[: len(task.movement)]


def _batch(task: Task, measures: NDArray, taken: NDArray, logs: dict[int, NDArray]) -> Batch:
    from backhoe.arm.closed_loop import kernels

    movement = task.movement
    samples = len(movement)
    diverged = taken < samples
    measures[:, kernels.ERRORS] = np.sqrt(measures[:, kernels.ERRORS] / samples)
    measures[:, kernels.EFFORTS] *= movement.dt
    measures[:, kernels.SATURATED] /= samples - 1
    measures[diverged] = np.inf
    last = np.minimum(taken, samples - 1)
    trajectories = {}
    for index, log in logs.items():
        kept = np.arange(0, last[index] + 1, task.record_every)
        q, dq, torque = np.moveaxis(log[: len(kept)], 1, 0)
        trajectories[index] = Trajectory(
            movement.t[kept], q.copy(), dq.copy(), torque.copy(), movement.q[kept]
        )
    return Batch(
        rms_error=measures[:, kernels.ERRORS],
        peak_error=measures[:, kernels.PEAK_ERRORS],
        final_error=measures[:, kernels.LAST_ERRORS],
        peak_torque=measures[:, kernels.PEAK_TORQUES],
        effort=measures[:, kernels.EFFORTS],
        saturated=measures[:, kernels.SATURATED],
        overrun=measures[:, kernels.OVERRUNS],
        diverged=diverged,
        stopped_at=movement.t[last],
        trajectories=trajectories,
    )
