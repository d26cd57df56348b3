"""Movement primitives: learning and rolling out against the library movement_primitives.

Four dimensions, 100 kernels, 13.68 s at 1 kHz; both give back what was shown. Times are the best of
several. Exit code 1 when a limit is missed.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from time import perf_counter

import numpy as np
from movement_primitives.dmp import DMP as Peer

from backhoe.planning.dmp import DMP, demonstration
from backhoe.planning.dmp.kernels import _basis


def fastest(function: Callable, repeats: int) -> float:
    """Shortest time of a call [s], after one that may compile."""
    function()
    times = []
    for _ in range(repeats):
        start = perf_counter()
        function()
        times.append(perf_counter() - start)
    return min(times)


def report(what: str, figure: float, limit: float) -> bool:
    verdict = "ok" if figure <= limit else "MISSED"
    print(f"{what:40s} {figure:8.4f} limit {limit:<6.3g} {verdict}")
    return figure <= limit


def main() -> int:
    t, x = demonstration("dig", 1e-3)
    peer, ours = Peer(4, execution_time=t[-1], dt=1e-3, n_weights_per_dim=100), DMP()

    def cold() -> None:
        _basis.cache_clear()
        ours.learn(x, t)

    learning, rolling = fastest(lambda: peer.imitate(t, x), 5), fastest(peer.open_loop, 4)
    warm, cold_one = fastest(lambda: ours.learn(x, t), 100), fastest(cold, 20)
    roll = fastest(ours.rollout, 100)
    assert np.abs(ours.rollout()[1] - x).max() < 2e-3
    assert np.abs(peer.open_loop()[1][: len(x)] - x).max() < 2e-2
    for name, one in (("peer learns", learning), ("peer rolls out", rolling), ("learns", warm)):
        print(f"{name:20s} {1e3 * one:8.2f} ms")
    print(f"{'learns, cold':20s} {1e3 * cold_one:8.2f} ms\n{'rolls out':20s} {1e3 * roll:8.2f} ms")
    ok = [
        report("learning, kernels kept, over the peer", warm / learning, 0.015),
        report("learning, cold, over the peer", cold_one / learning, 0.15),
        report("roll-out over the peer", roll / rolling, 0.006),
    ]
    return 0 if all(ok) else 1


if __name__ == "__main__":
    sys.exit(main())
