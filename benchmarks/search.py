"""RRT-Connect on the arm, 7 spheres among 6 obstacles, against OMPL with the same checker.

OMPL asks either the plain loops in Python or the compiled ones of the library; both planners get
the same starts, goals, step and resolution, and every way of both is looked at again. How long a
search takes depends on its samples, so that times are means over many of them, of the processor; of
OMPL the call of `solve` alone, of the library all of it. Exit code 1 when a limit is missed.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from itertools import pairwise
from time import process_time

import numpy as np
from ompl import base, geometric, util

from backhoe.planning.search import ArmWorld, engine, rrt_connect
from backhoe.planning.search.arm_loops import all_free
from backhoe.planning.search.checker import between

STEP, RESOLUTION, TRIES = 0.5, 0.05, 40
SPHERES = {
    "boom": [[-0.9, 0.2, 0.0, 0.55], [-2.2, 0.45, 0.0, 0.6], [-3.5, 0.3, 0.0, 0.55]],
    "stick": [[-0.4, 0.1, 0.0, 0.5], [-1.5, 0.1, 0.0, 0.5]],
    "bucket": [[-0.4, 0.2, 0.0, 0.7], [-1.1, 0.3, 0.0, 0.6]],
}
BOXES = [
    [[-1.3, 4.1, 0.0], [1.3, 8.0, 1.9]],
    [[-1.3, 8.3, 0.0], [1.3, 10.0, 3.0]],
    [[3.6, 3.6, 0.0], [4.2, 4.2, 4.5]],
]
BALLS = [[6.5, 0.0, -0.3, 1.5], [5.5, -2.0, 0.0, 1.0], [5.2, 2.5, 3.8, 0.7]]


def report(what: str, figure: float, unit: str, limit: float) -> bool:
    verdict = "ok" if figure <= limit else "MISSED"
    print(f"{what:60s} {figure:9.3g} {unit:5s} limit {limit:<6.3g} {verdict}")
    return figure <= limit


def jobs(world: ArmWorld, count: int = 12) -> list[tuple]:
    """Free postures at both sides of the obstacles that no straight way joins."""
    rng, found = np.random.default_rng(0), []
    while len(found) < count:
        q = rng.uniform(world.lower, world.upper, (2, 4))
        q[:, 0] = rng.uniform([-2.0, -0.6], [-1.2, 0.4])
        straight = world.is_free(between(*q, RESOLUTION)).all()
        if world.is_free(q).all() and not straight:
            found.append(tuple(q))
    return found


def with_ompl(world: ArmWorld, start, goal, valid: Callable) -> tuple[float, np.ndarray]:
    """Mean time [s] of OMPL's tries, and the last way."""
    space = base.RealVectorStateSpace(4)
    bounds = base.RealVectorBounds(4)
    for i in range(4):
        bounds.setLow(i, float(world.lower[i]))
        bounds.setHigh(i, float(world.upper[i]))
    space.setBounds(bounds)
    setup = geometric.SimpleSetup(space)
    information = setup.getSpaceInformation()
    information.setStateValidityCheckingResolution(RESOLUTION / space.getMaximumExtent())
    setup.setStateValidityChecker(valid)
    ends = space.allocState(), space.allocState()
    for state, q in zip(ends, (start, goal), strict=True):
        for i in range(4):
            state[i] = float(q[i])
    setup.setStartAndGoalStates(*ends)
    planner = geometric.RRTConnect(information)
    planner.setRange(STEP)
    setup.setPlanner(planner)
    setup.setup()
    times = []
    for _ in range(TRIES):
        setup.clear()
        begin = process_time()
        setup.solve(10.0)
        times.append(process_time() - begin)
        assert setup.haveExactSolutionPath()
    states = setup.getSolutionPath().getStates()
    return float(np.mean(times)), np.array([[state[i] for i in range(4)] for state in states])


def ours(world: ArmWorld, start, goal) -> tuple[float, np.ndarray]:
    times = []
    for seed in range(TRIES):
        begin = process_time()
        path = rrt_connect(
            start,
            goal,
            world.is_free,
            world.lower,
            world.upper,
            step=STEP,
            resolution=RESOLUTION,
            seed=seed,
        )
        times.append(process_time() - begin)
    return float(np.mean(times)), path


def main() -> int:
    util.setLogLevel(util.LOG_NONE)
    world = ArmWorld(SPHERES, BOXES, balls=BALLS)
    engine.compile_now()
    q = np.empty((1, 4))

    def posture(state) -> np.ndarray:
        q[0] = state[0], state[1], state[2], state[3]
        return q

    checkers = {
        "Python": lambda state: bool(all_free(world.numbers, posture(state))[0]),
        "Numba": lambda state: bool(engine.all_free(world.numbers, posture(state))[0]),
    }
    totals = {name: [] for name in ("library", *checkers)}
    for start, goal in jobs(world):
        runs = {"library": ours(world, start, goal)}
        runs |= {name: with_ompl(world, start, goal, valid) for name, valid in checkers.items()}
        for name, (time, path) in runs.items():
            totals[name].append(time)
            fine = np.vstack([between(a, b, RESOLUTION) for a, b in pairwise(path)])
            assert world.is_free(fine).mean() > (0.999 if name == "library" else 0.9)
    means = {name: float(np.mean(times)) for name, times in totals.items()}
    print({name: f"{1e3 * time:.3f} ms" for name, time in means.items()})
    ok = [
        report(
            "RRT-Connect over OMPL's, Python checker", means["library"] / means["Python"], "", 0.05
        ),
        report(
            "RRT-Connect over OMPL's, Numba checker", means["library"] / means["Numba"], "", 0.15
        ),
    ]
    return 0 if all(ok) else 1


if __name__ == "__main__":
    sys.exit(main())
