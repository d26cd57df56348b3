"""Kinematics and dynamics of the arm against Pinocchio: same answers, ratio of the times.

Exit code 1 when a limit is missed or an answer differs by more than 1e-9 of its largest.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import numpy as np
import pinocchio as pin

from backhoe.arm import dynamics, kinematics
from backhoe.machine import BACKHOE

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from oracles import pinocchio_model

MANY = 1_000_000
LOOPED = 50_000
THREADS = 2


def best_time(function: Callable[[], object], repeats: int = 7) -> float:
    """Shortest of some runs, after one to warm up [s]."""
    function()
    times = []
    for _ in range(repeats):
        start = perf_counter()
        function()
        times.append(perf_counter() - start)
    return min(times)


def report(what: str, figure: float, unit: str, limit: float) -> bool:
    verdict = "ok" if figure <= limit else "MISSED"
    print(f"{what:58s} {figure:9.3g} {unit:5s} limit {limit:<6g} {verdict}")
    return figure <= limit


def difference(ours: np.ndarray, theirs: np.ndarray) -> float:
    """Largest difference relative to the largest entry."""
    return float(np.abs(ours - theirs).max() / np.abs(theirs).max())


def mass_matrices_of(model, data, postures: np.ndarray) -> np.ndarray:
    """Pinocchio's loop, with what it takes to keep the results."""
    found = np.empty((len(postures), 4, 4))
    for i, q in enumerate(postures):
        found[i] = pin.crba(model, data, q)
    upper = np.triu(found)
    return upper + np.swapaxes(np.triu(found, 1), -1, -2)


def bare_loop(model, data, postures: np.ndarray) -> None:
    for q in postures:
        pin.crba(model, data, q)


def measure_mass_matrix(model, data, q: np.ndarray) -> list[bool]:
    few = q[:LOOPED]
    same = difference(dynamics.mass_matrix(q)[:LOOPED], mass_matrices_of(model, data, few))
    ours = best_time(lambda: dynamics.mass_matrix(q)) / len(q)
    bare = best_time(lambda: bare_loop(model, data, few), 5) / LOOPED
    small = best_time(lambda: dynamics.mass_matrix(q[:10_000]), 20) / 10_000
    one = best_time(lambda: [dynamics.mass_matrix(x) for x in q[:100]], 200) / 100
    print(
        f"M(q): {1e9 * ours:.0f} ns in 1e6, {1e9 * small:.0f} ns in 1e4; crba {1e9 * bare:.0f} ns"
    )
    return [
        report("M(q) against Pinocchio, difference", same, "", 1e-9),
        report("M(q) of 1e6 over a bare loop of pin.crba", ours / bare, "", 0.10),
        report("M(q), cost per item of 1e6 over that of 1e4", ours / small, "", 1.25),
        report("M(q), one call", 1e6 * one, "us", 15),
    ]


def measure_inverse_dynamics(model, q: np.ndarray, dq: np.ndarray, ddq: np.ndarray) -> list[bool]:
    columns = [np.asfortranarray(part.T) for part in (q, dq, ddq)]
    theirs = np.zeros((4, len(q)), order="F")
    pools = {threads: pin.ModelPool(model, threads) for threads in (1, THREADS)}
    pin.rneaInParallel(1, pools[1], *columns, theirs)
    same = difference(dynamics.inverse_dynamics(q, dq, ddq), theirs.T)
    ours = best_time(lambda: dynamics.inverse_dynamics(q, dq, ddq))
    few = [part[:10_000] for part in (q, dq, ddq)]
    small = best_time(lambda: dynamics.inverse_dynamics(*few), 20) * len(q) / 10_000
    print(f"inverse dynamics: {1e9 * ours / len(q):.0f} ns in 1e6, {1e3 * small:.0f} ns in 1e4")
    lines = [report("inverse dynamics against Pinocchio, difference", same, "", 1e-9)]
    for threads, pool in pools.items():
        peer = best_time(lambda n=threads, pool=pool: pin.rneaInParallel(n, pool, *columns, theirs))
        what = f"inverse dynamics of 1e6 over rneaInParallel, {threads} threads"
        lines.append(report(what, ours / peer, "", 0.25))
    return [
        *lines,
        report("inverse dynamics, cost per item of 1e6 over that of 1e4", ours / small, "", 1.25),
    ]


def measure_inverse_kinematics(q: np.ndarray) -> list[bool]:
    target = kinematics.pose(q)
    same = difference(kinematics.inverse_kinematics(target), q)
    ours = best_time(lambda: kinematics.inverse_kinematics(target))
    small = best_time(lambda: kinematics.inverse_kinematics(target[:10_000]), 20) * len(q) / 10_000
    return [
        report("inverse kinematics of 1e6, back to the same angles", same, "", 1e-9),
        report("inverse kinematics of 1e6", ours, "s", 0.1),
        report("inverse kinematics, cost per item of 1e6 over 1e4", ours / small, "", 1.25),
    ]


def measure_import() -> list[bool]:
    def start_up(code: str) -> float:
        return best_time(lambda: subprocess.run([sys.executable, "-c", code], check=True), 10)

    numpy_alone = start_up("import numpy")
    package = start_up("import backhoe, numpy") - numpy_alone
    mathematics = start_up("from backhoe.arm import dynamics, integrate, kinematics") - numpy_alone
    return [
        report("import backhoe beyond NumPy", package, "s", 0.15),
        report("import kinematics, dynamics, integrate beyond NumPy", mathematics, "s", 0.15),
    ]


def main() -> int:
    rng = np.random.default_rng(0)
    model = pinocchio_model()
    data = model.createData()
    q = rng.uniform(BACKHOE.lower, BACKHOE.upper, (MANY, 4))
    dq, ddq = rng.uniform(-1, 1, (2, MANY, 4))
    lines = [
        *measure_mass_matrix(model, data, q),
        *measure_inverse_dynamics(model, q, dq, ddq),
        *measure_inverse_kinematics(q),
        *measure_import(),
    ]
    return 0 if all(lines) else 1


if __name__ == "__main__":
    sys.exit(main())
