"""Closed loops of the arm by the hundred, against MuJoCo's batch roll-out of the same arm.

MuJoCo gets the easier task: its actuators hold a PD law with a feed-forward torque from outside, in
place of the sampled PID with limits, anti-windup, Coulomb friction and measures. Beside it, for one
run: SciPy's solve_ivp from sample to sample, and PyBullet with the same PID.

Exit code 1 when a limit is missed or the trajectories differ.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time

import mujoco
import numpy as np
from mujoco import rollout
from scipy.integrate import solve_ivp

from backhoe import simulation
from backhoe.arm import closed_loop, dynamics, movement, pid
from backhoe.arm.movement import Movement
from backhoe.machine import BACKHOE, JOINTS, Machine, replace

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from oracles import mjcf

RUNS = 300
THREADS = 2
CHECKED = 8.0
"""Seconds over which the trajectories are compared."""

ONE_RUN = 2.0
"""Seconds of the movement that SciPy and PyBullet simulate."""

RK4, EULER = mujoco.mjtIntegrator.mjINT_RK4, mujoco.mjtIntegrator.mjINT_EULER


def best_time(function: Callable[[], object], repeats: int, clock=perf_counter) -> float:
    """Shortest of some runs [s]."""
    times = []
    for _ in range(repeats):
        start = clock()
        function()
        times.append(clock() - start)
    return min(times)


def report(what: str, figure: float, unit: str, limit: float) -> bool:
    verdict = "ok" if figure <= limit else "MISSED"
    print(f"{what:58s} {figure:9.3g} {unit:5s} limit {limit:<6g} {verdict}")
    return figure <= limit


def some_gains(count: int) -> pid.Gains:
    """The course's gains, each changed by up to a half; all of them follow the movement."""
    rng = np.random.default_rng(0)
    return pid.Gains(
        *(np.array(gain) * rng.uniform(0.5, 1.5, (count, 4)) for gain in pid.ARM_GAINS)
    )


def beginning(whole: Movement, seconds: float) -> Movement:
    end = round(seconds / whole.dt) + 1
    return Movement(whole.t[:end], whole.q[:end], whole.dq[:end], whole.ddq[:end])


def without_coulomb(machine: Machine) -> Machine:
    """MuJoCo has no smoothed Coulomb friction: for the comparison nobody has any."""
    parts = {
        name: replace(part, joint=replace(part.joint, coulomb=0.0))
        for name, part in zip(JOINTS, (machine.swing, *machine.links), strict=True)
    }
    return replace(machine, **parts)


def rolled_out(models: list, control: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Joint angles (n, steps, 4) of MuJoCo's batch roll-out on all threads."""
    data = [mujoco.MjData(models[0]) for _ in range(THREADS)]
    state = np.zeros((len(models), mujoco.mj_stateSize(models[0], rollout_state())))
    state[:, 1:5] = start
    with rollout.Rollout(nthread=THREADS) as roll:
        states, _ = roll.rollout(models, data, state, control)
    return states[:, :, 1:5]


def rollout_state() -> int:
    return int(mujoco.mjtState.mjSTATE_FULLPHYSICS)


def with_pd(gains: pid.Gains, index: int) -> mujoco.MjModel:
    """The arm with the PD law of one run in its actuators; the control is what the law adds."""
    law = "".join(
        f'<general joint="{joint}" biastype="affine" biasprm="0 {-kp!r} {-kd!r}"/>'
        for joint, kp, kd in zip(
            JOINTS, gains.kp[index].tolist(), gains.kd[index].tolist(), strict=True
        )
    )
    return mujoco.MjModel.from_xml_string(mjcf(actuators=law))


def measure_agreement(reference: Movement) -> list[bool]:
    """The torques of our run, given to MuJoCo sample by sample."""
    plain, short = without_coulomb(BACKHOE), beginning(reference, CHECKED)
    run = closed_loop.simulate(pid.ARM_GAINS, short, machine=plain, settled=True, record=[0])
    found = run.trajectory(0)
    model = mujoco.MjModel.from_xml_string(mjcf(plain))
    model.opt.integrator = RK4
    theirs = rolled_out([model], found.torque[None, :-1], found.q[:1])[0]
    difference = float(np.abs(theirs - found.q[1:]).max())
    what = f"angles against MuJoCo, {CHECKED:g} s at the same torques"
    return [report(what, difference, "rad", 1e-9)]


def mujoco_time(
    reference: Movement, gains: pid.Gains, runs: int, integrator: int, repeats: int
) -> float:
    """Time of the roll-out of some runs, in portions that fit the memory [s]."""
    models = [with_pd(gains, index) for index in range(runs)]
    for model in models:
        model.opt.integrator = integrator
    feed = dynamics.gravity_torque(reference.q[:-1])
    total = 0.0
    for first in range(0, runs, 30):
        part = slice(first, min(first + 30, runs))
        kp, kd = (gain[part, None] for gain in (gains.kp, gains.kd))
        control = kp * reference.q[:-1] + kd * reference.dq[:-1] + feed
        total += best_time(
            lambda part=part, control=control: rolled_out(models[part], control, reference.q[0]),
            repeats,
        )
    return total


def measure_batch(reference: Movement) -> list[bool]:
    gains, limit = some_gains(RUNS), BACKHOE.torque_limit

    def ours(count: int) -> float:
        part = pid.Gains(*(gain[:count] for gain in gains))
        return best_time(
            lambda: closed_loop.simulate(part, reference, torque_limit=limit, settled=True), 3
        )

    ours(8)
    batch = ours(RUNS)
    euler = mujoco_time(reference, gains, RUNS, EULER, 1)
    rk4 = mujoco_time(reference, gains, 30, RK4, 1) * RUNS / 30
    print(f"{RUNS} x {reference.t[-1]:g} s at 1 kHz: ours {batch:.2f} s, MuJoCo {euler:.1f} s by")
    print(f"Euler's rule, {rk4:.1f} s by Runge-Kutta's as ours (30 runs, times ten)")
    return [
        report("batch over MuJoCo, Euler's rule", batch / euler, "", 0.15),
        report("batch over MuJoCo, Runge-Kutta's rule", batch / rk4, "", 0.15),
        *measure_cost_per_run(reference),
    ]


def measure_cost_per_run(reference: Movement) -> list[bool]:
    gains = some_gains(3000)
    short = beginning(reference, 3.5)

    def cost(count: int, repeats: int) -> float:
        part = pid.Gains(*(gain[:count] for gain in gains))
        return best_time(lambda: closed_loop.simulate(part, short), repeats, process_time) / count

    few, many = cost(30, 20), cost(3000, 3)
    print(f"3.5 s, processor time: {1e3 * few:.3f} ms a run in 30, {1e3 * many:.3f} ms in 3000")
    return [report("cost of a run in 3000 over that in 30", many / few, "", 1.1)]


def scipy_run(reference: Movement) -> np.ndarray:
    """One run by DOP853 from sample to sample."""
    controller = pid.PID(*pid.ARM_GAINS)

    def resistance(dq):
        return dynamics.friction_torque(dq, smoothing=closed_loop.COULOMB_SMOOTHING)

    def rate(t, x, torque):
        return np.r_[x[4:], dynamics.forward_dynamics(x[:4], x[4:], torque, resistance)]

    x = np.r_[reference.q[0], reference.dq[0]]
    angles = [x[:4]]
    for q_ref, dq_ref in zip(reference.q[:-1], reference.dq[:-1], strict=True):
        torque = controller(q_ref, dq_ref, x[:4], x[4:], reference.dt)
        step = solve_ivp(
            rate, (0, reference.dt), x, "DOP853", args=(torque,), rtol=1e-12, atol=1e-12
        )
        x = step.y[:, -1]
        angles.append(x[:4])
    return np.array(angles)


def bullet_run(reference: Movement) -> None:
    """One run in PyBullet, the PID in Python."""
    controller = pid.PID(*pid.ARM_GAINS)
    with simulation.open_world(
        backend="pybullet", soil=False, base="fixed", q=reference.q[0]
    ) as world:
        for q_ref, dq_ref in zip(reference.q, reference.dq, strict=True):
            world.step(controller(q_ref, dq_ref, world.q, world.dq, world.dt))


def measure_one_run(reference: Movement) -> list[bool]:
    short = beginning(reference, ONE_RUN)
    found = closed_loop.simulate(pid.ARM_GAINS, short, record=[0]).trajectory(0)
    exact = scipy_run(short)
    few = best_time(lambda: closed_loop.simulate(pid.ARM_GAINS, short), 20)
    peers = {"SciPy": best_time(lambda: scipy_run(short), 2)}
    peers["PyBullet"] = best_time(lambda: bullet_run(short), 2)
    for name, seconds in peers.items():
        print(f"one run of {ONE_RUN:g} s: ours over {name} {few / seconds:.2g}")
    difference = float(np.abs(exact - found.q).max())
    return [report("angles against DOP853, sample by sample", difference, "rad", 1e-9)]


def main() -> int:
    reference = movement.loading()
    lines = [
        *measure_agreement(reference),
        *measure_one_run(reference),
        *measure_batch(reference),
    ]
    return 0 if all(lines) else 1


if __name__ == "__main__":
    sys.exit(main())
