"""Soil: time of a tick while digging, in the air and between ticks, and the first call's price.

Exit code 1 when a limit is missed.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from math import cos, radians, sin
from time import perf_counter

import numpy as np

from backhoe.simulation.soil.ground import Ground, Terrain

DT = 0.01


def report(what: str, figure: float, unit: str, limit: float) -> bool:
    verdict = "ok" if figure <= limit else "MISSED"
    print(f"{what:58s} {figure:9.3g} {unit:5s} limit {limit:<6g} {verdict}")
    return figure <= limit


def scene() -> Ground:
    terrain = Terrain.flat((-3.0, 9.8), (-6.4, 6.4), 0.08).with_heap(6.0, 0.0, 1.0, 2.2)
    bed = Terrain.bed((0.8, 5.3), 4.4, 2.3, floor=1.1, wall=1.9)
    return Ground(terrain, bed, hold=0.001)


def tip_pose(r: float, z: float, pitch_deg: float, heading: float) -> np.ndarray:
    pitch = radians(pitch_deg)
    (ex, ey), (c, s) = (cos(heading), sin(heading)), (cos(pitch), sin(pitch))
    return np.array(
        [
            [c * ex, -s * ex, ey, r * ex],
            [c * ey, -s * ey, -ex, r * ey],
            [s, c, 0.0, z],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


WAY = np.array(
    [
        (7.3, 1.6, -75, 0.0),
        (7.2, 0.5, -80, 0.0),
        (6.0, 0.25, -110, 0.0),
        (5.2, 0.45, -150, 0.0),
        (4.9, 0.9, -178, 0.0),
        (4.7, 2.6, -178, 0.0),
        (5.0, 3.4, -178, 1.35),
        (5.0, 3.4, -20, 1.35),
    ]
)


def dig(ground: Ground) -> list[float]:
    """Dig, swing and dump once along straight lines; the time of each tick [s]."""
    ticks, times, last = 150, [], tip_pose(*WAY[0])[:3, 3]
    ground.forget_pose()
    for leg in range(len(WAY) - 1):
        for k in range(ticks):
            T = tip_pose(*(WAY[leg] + k / ticks * (WAY[leg + 1] - WAY[leg])))
            velocity, last = (T[:3, 3] - last) / DT, T[:3, 3]
            start = perf_counter()
            ground.advance(T, velocity, DT)
            times.append(perf_counter() - start)
    return times


def fastest(function, number: int = 2000, repeats: int = 7) -> float:
    """Shortest mean time of a call [s]."""
    means = []
    for _ in range(repeats):
        start = perf_counter()
        for _ in range(number):
            function()
        means.append((perf_counter() - start) / number)
    return min(means)


def first_digging(cache: str) -> float:
    """Time to build a scene and dig once in a new process [s]."""
    run = subprocess.run(
        [sys.executable, __file__, "once"],
        env={**os.environ, "NUMBA_CACHE_DIR": cache},
        capture_output=True,
        text=True,
        check=True,
    )
    return float(run.stdout)


def main() -> int:
    ground = scene()
    dig(ground)
    print(f"terrain {ground.terrain.heights.shape}, bed {ground.bed.heights.shape}")
    runs = [dig(scene()) for _ in range(5)]
    digging = min(float(np.mean(run[:750])) for run in runs)
    whole = min(float(np.mean(run)) for run in runs)
    ok = [
        report("advance while digging, mean", digging * 1e3, "ms", 0.3),
        report("advance over dig, swing and dump, mean", whole * 1e3, "ms", 0.3),
    ]
    hanging, still = tip_pose(5.0, 3.4, -178, 0.5), np.zeros(3)
    settled = scene()
    idle = fastest(lambda: settled.advance(hanging, still, DT))
    ok.append(report("advance in the air, empty", idle * 1e6, "us", 20))
    settled.bucket_volume = 0.4
    idle = fastest(lambda: settled.advance(hanging, still, DT))
    ok.append(report("advance in the air, loaded", idle * 1e6, "us", 20))
    position, velocity = np.array([6.0, 0.0, 0.3]), np.array([-0.3, 0.0, 0.1])
    buried = scene()
    for x in (6.05, 6.0):
        buried.advance(tip_pose(x, 0.3, -90, 0.0), velocity, DT)
    between = fastest(lambda: buried.force(position, velocity))
    ok.append(report("force between two ticks", between * 1e6, "us", 5))
    with tempfile.TemporaryDirectory() as cache:
        ok.append(report("build and dig once, compiling", first_digging(cache), "s", 15))
        ok.append(report("build and dig once, from the cache", first_digging(cache), "s", 3))
    return 0 if all(ok) else 1


def once() -> None:
    start = perf_counter()
    dig(scene())
    print(perf_counter() - start)


if __name__ == "__main__":
    sys.exit(once() if sys.argv[1:] == ["once"] else main())
