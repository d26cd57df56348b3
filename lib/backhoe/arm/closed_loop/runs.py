"""A batch of closed-loop simulations of the arm."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.closed_loop.batch import Batch, Trajectory
from backhoe.arm.closed_loop.rows import LANES
from backhoe.arm.closed_loop.task import LAWS, Task
from backhoe.arm.dynamics.terms import Arm, arm_of
from backhoe.arm.movement import Movement
from backhoe.arm.pid import Gains
from backhoe.basics.inputs import whole
from backhoe.basics.tiles import cores

LARGEST_ERROR = pi
"""A run whose joint is half a turn away from its reference has diverged [rad]."""

LARGEST_SPEED = 50.0
"""A run with a joint as fast as this has diverged [rad/s]."""


class Sampling(NamedTuple):
    """`dt` [s], samples between two readings of the joints, whether the derivative is of measured
    speeds, `filter_time` of differences [s], and from what error [rad] and speed [rad/s] on a run
    counts as diverged."""

    dt: float
    hold: int
    measured: bool
    filter_time: float
    largest_error: float
    largest_speed: float


class Loop(NamedTuple):
    """What all runs share.

    The `arm` without payload, the law's `model` of it and the `law`'s index; viscous [N m s/rad]
    and Coulomb `friction` [N m], shape (2, 4); torque `limit` [N m], `lower` and `upper` end of the
    range [rad], shape (4,) each; `reference` q, dq, ddq, shape (3, m, 4) [rad, rad/s, rad/s^2], and
    the rates `settling` a slow speed there, shape (m, 4) [1/s].
    """

    arm: Arm
    model: Arm
    law: int
    friction: NDArray
    limit: NDArray
    lower: NDArray
    upper: NDArray
    reference: NDArray
    settling: NDArray
    sampling: Sampling


class Log(NamedTuple):
    """`every` which sample of run i goes into rows[of[i]], (m, 3, 4): q, dq, torque; -1: none."""

    every: int
    of: NDArray
    rows: NDArray


def simulate(
    gains: Gains, movement: Movement, *, threads: int | None = None, **options: object
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
    reproduces. With friction, viscous friction and a smoothed Coulomb friction act as in
    `simulation`. The stops at the ends of the joints' ranges are not modelled; `Batch.overrun`
    tells of them.

    Source: Mastalli 2013, eqs. (3.1), (3.2) and (3.28).

    Args:
        gains: each of shape (n, 4), or (4,) for one run [N m/rad, N m/(rad s), N m s/rad; 1/s^2,
            1/s^3, 1/s for "computed_torque"].
        movement: the reference; its dt is the sampling time.
        threads: 1 for the caller's alone; None for one on each core.
        machine: the arm that moves, its bucket empty; `BACKHOE` unless told.
        model: the law's model of the arm; `machine` unless told.
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

    Returns:
        Measures of the n runs, and the recorded ones. A run with an error of `LARGEST_ERROR` or a
        joint as fast as `LARGEST_SPEED` is stopped and marked as diverged.

    Raises:
        ValueError: an array of another shape, a value that is not finite, negative gains or
            payload, an unknown law, settled with a K_i that cannot hold the arm.
        TypeError: gains are no Gains, movement is no Movement, or an unknown option.
    """
    threads = cores() if threads is None else whole(threads, "threads", least=1)
    return carry_out(Task(gains, movement, **options), threads)


def carry_out(task: Task, threads: int) -> Batch:
    """Simulate all runs of a task."""
    from backhoe.arm.closed_loop import engine

    count, loop = len(task), _loop(task)
    measures, taken = np.zeros((count, 7, 4)), np.zeros(count, dtype=int)
    rows = -(-len(task.movement) // task.record_every)
    logs, log_of = np.empty((len(task.record), rows, 3, 4)), np.full(count, -1)
    log_of[list(task.record)] = np.arange(len(task.record))
    own = np.zeros((count, 7, 4))
    own[:, :3] = np.stack(task.gains, axis=1)
    own[:, 3], own[:, 4], own[:, 5] = task.q0, task.movement.dq[0], task.integral
    own[:, 6, 0] = task.payload

    def run_block(block: slice) -> None:
        log = Log(task.record_every, log_of[block], logs)
        taken[block] = engine.run(loop, own[block], log, measures[block])

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


def _loop(task: Task) -> Loop:
    machine, movement = task.machine, task.movement
    sampling = Sampling(
        movement.dt,
        task.state_every,
        task.rate == "measured",
        task.filter_time,
        LARGEST_ERROR,
        LARGEST_SPEED,
    )
    return Loop(
        *(Arm(*map(float, arm_of(m))) for m in (machine, task.model)),
        LAWS.index(task.law),
        task.friction * np.stack([machine.viscous, machine.coulomb]),
        *(np.array(limit) for limit in (task.torque_limit, machine.lower, machine.upper)),
        np.stack([movement.q, movement.dq, movement.ddq]),
        task.settling_rates,
        sampling,
    )


def _batch(task: Task, measures: NDArray, taken: NDArray, logs: dict[int, NDArray]) -> Batch:
    from backhoe.arm.closed_loop import engine

    movement = task.movement
    samples = len(movement)
    diverged = taken < samples
    measures[:, engine.ERRORS] = np.sqrt(measures[:, engine.ERRORS] / samples)
    measures[:, engine.EFFORTS] *= movement.dt
    measures[:, engine.SATURATED] /= samples - 1
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
        rms_error=measures[:, engine.ERRORS],
        peak_error=measures[:, engine.PEAK_ERRORS],
        final_error=measures[:, engine.LAST_ERRORS],
        peak_torque=measures[:, engine.PEAK_TORQUES],
        effort=measures[:, engine.EFFORTS],
        saturated=measures[:, engine.SATURATED],
        overrun=measures[:, engine.OVERRUNS],
        diverged=diverged,
        stopped_at=movement.t[last],
        trajectories=trajectories,
    )
