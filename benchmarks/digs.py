"""Digs as tries: 150 of the demonstration's length, side by side on two cores.

Exit code 1 when the limit is missed.
"""

from __future__ import annotations

import sys
from time import perf_counter

import numpy as np

from backhoe.planning.dmp.demonstrations import demonstration
from backhoe.simulation.trial import dig_many

COUNT, CORES, LIMIT = 150, 2, 20.0


def main() -> int:
    times, path = demonstration("dig", 0.02)
    rng = np.random.default_rng(0)
    paths = [path + 0.02 * rng.normal(size=4) for _ in range(COUNT)]
    dig_many(paths[:CORES], times, processes=CORES)  # the workers start and load
    start = perf_counter()
    dug = dig_many(paths, times, processes=CORES)
    seconds = perf_counter() - start
    verdict = "ok" if seconds <= LIMIT else "MISSED"
    what = f"{COUNT} digs of {dug[0].duration:.1f} s on {CORES} cores"
    print(f"{what:40s} {seconds:6.1f} s  limit {LIMIT:g}  {verdict}")
    return int(seconds > LIMIT)


if __name__ == "__main__":
    sys.exit(main())
