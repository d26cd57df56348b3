"""How fast the simulation runs, beside PyBullet's bare stepping of the same world.

    python benchmarks/simulation.py [seconds of simulated time]

Prints times faster than real time, by processor time of this process. A run repeats bit for bit, so
each stretch of it counts with the fastest of its repetitions: what else the machine does drops out.
"""

from __future__ import annotations

import sys
from math import ceil
from time import process_time

import numpy as np

from backhoe import mission, simulation
from backhoe.arm import dynamics, kinematics, pid

RUNS = 5
STRETCH = 250


def follow(world, seconds):
    """The joint PID at 1 kHz along the mission's cycles; seconds for each stretch."""
    controller = pid.PID(*pid.ARM_GAINS, world.machine.torque_limit)
    steps = round(seconds / world.dt)
    plan = [point for cycle in range(ceil(seconds / 20)) for point in mission.hand_made_plan(cycle)]
    way = kinematics.inverse_kinematics([point.target for point in plan])
    at = np.cumsum([0.0, *(point.time for point in plan)])
    q_ref, dq_ref = mission.smooth_trajectory(
        at, np.vstack([world.q, way]), world.dt * np.arange(steps)
    )
    holding = dynamics.gravity_torque(q_ref)
    times = [process_time()]
    for step in range(steps):
        feedback = controller(q_ref[step], dq_ref[step], world.q, world.dq, world.dt)
        world.step(feedback + holding[step])
        if (step + 1) % STRETCH == 0:
            times.append(process_time())
    return np.diff(times)


def bare(world, seconds):
    """PyBullet's own step with constant torques and nothing read; seconds for each stretch."""
    server, body, hold = world._server, world._body, world._state.forces
    times = [process_time()]
    for step in range(round(seconds / world.dt)):
        server.push(body, world._moving, hold)
        if (step + 1) % STRETCH == 0:
            times.append(process_time())
    return np.diff(times)


def best(measure, seconds, **options):
    runs = []
    for _ in range(RUNS):
        with simulation.open_world(**options) as world:
            world.step(dynamics.gravity_torque(world.q))
            runs.append(measure(world, seconds))
    return seconds / np.min(runs, axis=0).sum()


def picture(shadow):
    times = []
    with simulation.open_world(backend="pybullet") as world:
        for _ in range(RUNS + 1):
            world.ground.terrain.restore(world.ground.terrain.snapshot())
            start = process_time()
            world.render(640, 480, shadow=shadow)
            times.append(process_time() - start)
    return min(times[1:])


def balancing(backend: str) -> float:
    """What the margin of the balance costs a step, the truck's contacts included [s]."""
    with simulation.open_world(backend=backend) as world:
        world.step(dynamics.gravity_torque(world.q))
        parts = [world._stand, *([world._feel] if backend == "pybullet" else [])]
        times = []
        for _ in range(20):
            start = process_time()
            for _ in range(2000):
                for part in parts:
                    part()
            times.append(process_time() - start)
    return min(times) / 2000


def main(seconds: float = 20.0) -> None:
    rows = [
        ("PyBullet, bare stepSimulation", best(bare, seconds, backend="pybullet", soil=False)),
        ("PyBullet, PID at 1 kHz, no soil", best(follow, seconds, backend="pybullet", soil=False)),
        ("PyBullet, PID at 1 kHz, with soil", best(follow, seconds, backend="pybullet")),
        ("analytic, PID at 1 kHz, no soil", best(follow, seconds, backend="analytic", soil=False)),
        ("analytic, PID at 1 kHz, with soil", best(follow, seconds, backend="analytic")),
    ]
    for name, speed in rows:
        print(f"{name:<36}{speed:7.1f} x real time   {rows[0][1] / speed:5.1f} x bare")
    for backend in ("analytic", "pybullet"):
        cost = 1e6 * balancing(backend)
        print(f"balance of a step, {backend:<17}{cost:7.2f} us        limit 3 us")
    for shadow in (False, True):
        print(
            f"picture 640 x 480, new terrain, shadow {shadow!s:<6}{1e3 * picture(shadow):6.0f} ms"
        )


if __name__ == "__main__":
    main(*map(float, sys.argv[1:]))
