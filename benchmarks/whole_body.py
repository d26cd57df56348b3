"""Velocities of a mobile manipulator: least ones alone and many at once, and within limits against
quadprog called bare; and the whole controller with the machine in soil.

Times are the best of many, so that what else the machine does counts little; those of many states,
which take long, are of the processor. Exit code 1 when a
limit is missed.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from time import perf_counter, process_time

import numpy as np
import quadprog

from backhoe import simulation
from backhoe.mission.passes import edge_posture
from backhoe.simulation.whole_body_plant import WholeBodyPlant
from backhoe.whole_body import (
    follow,
    hand,
    jacobian,
    joint_bounds,
    limited_velocity,
    limits,
    minimum_norm,
    sine_path,
    track_rows,
)

STATES = 100_000


def report(what: str, figure: float, unit: str, limit: float) -> bool:
    verdict = "ok" if figure <= limit else "MISSED"
    print(f"{what:60s} {figure:9.3g} {unit:5s} limit {limit:<6.3g} {verdict}")
    return figure <= limit


def fastest(
    function: Callable, calls: int = 50, repeats: int = 200, clock: Callable = perf_counter
) -> float:
    """Shortest time of a call [s], of some calls in a row, after one that may compile."""
    function()
    times = []
    for _ in range(repeats):
        start = clock()
        for _ in range(calls):
            function()
        times.append((clock() - start) / calls)
    return min(times)


def least_velocities() -> list[bool]:
    rng = np.random.default_rng(0)
    J = jacobian(rng.uniform(-1.2, 1.2, (STATES, 7)))
    b, v0 = rng.normal(size=(STATES, 3)), rng.normal(size=(STATES, 6))
    v = np.empty((STATES, 6))

    def loop() -> None:
        for k in range(STATES):
            v[k] = minimum_norm(J[k], b[k], v0[k])

    one = fastest(lambda: minimum_norm(J[0], b[0], v0[0]))
    looped = fastest(loop, 1, 3, process_time)
    together = fastest(lambda: minimum_norm(J, b, v0), 1, 30, process_time)
    assert (v == minimum_norm(J, b, v0)).all()
    print(f"{STATES} states at once: {together * 1e9 / STATES:.0f} ns each")
    return [
        report("minimum norm and null space, 6 velocities, a step", one * 1e6, "us", 15),
        report("1e5 at once over a loop", together / looped, "", 0.02),
    ]


def within_limits() -> list[bool]:
    """The programmes that the library hands to quadprog, and the same bare; in a row with the
    tracks' limits."""
    rng, ok = np.random.default_rng(1), []
    tracks = track_rows()._asdict()
    for what, further in (("joints", {}), ("joints and tracks", tracks)):
        ratios = []
        for _ in range(5):
            q = rng.uniform(-0.5, 0.5, 7)
            J, b, v0 = jacobian(q), rng.normal(size=3), rng.normal(size=6) / 10
            lower, upper = (
                np.r_[-2.0, -1.0, bound] if k == 0 else np.r_[2.0, 1.0, bound]
                for k, bound in enumerate(
                    joint_bounds(q[3:], np.full(4, -1.5), np.full(4, 1.5), np.full(4, 0.5), 0.01)
                )
            )

            def step(J=J, b=b, lower=lower, upper=upper, v0=v0, further=further):
                return limited_velocity(J, b, lower, upper, preferred=v0, **further)

            given = []
            solver, limits.solver = limits.solver, lambda given=given: kept(given)
            found = step()
            limits.solver = solver
            bare = quadprog.solve_qp(*given[0])[0]
            assert np.abs(bare - [*found.v, found.s]).max() < 1e-6
            times = fastest(step), fastest(lambda given=given: quadprog.solve_qp(*given[0]))
            ratios.append(times[0] / times[1])
        print(f"the step with limits of {what}: {times[0] * 1e6:.1f} us, bare {times[1] * 1e6:.1f}")
        ok.append(report(f"limits of {what}, over quadprog bare", np.median(ratios), "", 2.5))
    return ok


def kept(given: list) -> Callable:
    """quadprog's solver, that keeps what it is given."""

    def solve(*arguments: object) -> tuple:
        given.append(arguments)
        return quadprog.solve_qp(*arguments)

    return solve


def in_soil(seconds: float = 8.0) -> list[bool]:
    """The bucket draws a line through the soil, in PyBullet at 1 kHz, the controller at 100 Hz."""
    start = edge_posture([6.3, 0.05, np.radians(-110)])
    line = sine_path(
        hand([0, 0, 0, *start]),
        seconds,
        length=2.0,
        waves=0.5,
        sideways=0.0,
        upwards=-0.13,
        heading=np.pi,
    )
    times = []
    for _ in range(3):
        with simulation.open_world(backend="pybullet", scene=simulation.FLAT, q=start) as world:
            plant = WholeBodyPlant(world)
            begin = process_time()
            follow(plant, line, W=0.8, preferred=lambda q: np.array([0, 0, *(start - q[3:])]))
            times.append(process_time() - begin)
            print(f"bucket: {world.ground.bucket_volume:.2f} m^3 of soil")
    return [
        report(
            "a second of the controller in PyBullet with soil", min(times) / seconds, "s", 1 / 15
        )
    ]


if __name__ == "__main__":
    jobs = least_velocities, within_limits, in_soil
    results = [fine for job in jobs for fine in job()]
    sys.exit(0 if all(results) else 1)
