"""`python tests/planning/write_practice.py` practises the dig and writes data/practice/dig.csv.

Three methods, ten seeds each, 150 tries a seed: 4,500 digs, a quarter of an hour on two cores.
CMA-ES is that of the package `cma` (requirements-dev.txt): the peer, which no lesson needs.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from backhoe.mission.dig_practice import FILE, SPREAD, DigPractice
from backhoe.planning.improve import Learning, pi2, power

SEEDS, BATCH, BUDGET = 10, 10, 150
FAILED = 1e3
"""What CMA-ES is told of a failed try: it ranks, so any large number will do."""


def cma_es(cost, start, spread, *, batch=BATCH, budget=BUDGET, rng=0) -> Learning:
    """The peer, with the start as its first try and the same number of tries in all."""
    import cma

    options = {"popsize": batch, "seed": int(rng) + 1, "verbose": -9}
    search = cma.CMAEvolutionStrategy(start, spread, options)
    tries, costs = [start], [*cost(np.array([start]))]
    while len(costs) < budget:
        asked = search.ask()
        fresh = asked[: budget - len(costs)]
        given = cost(np.array(fresh))
        tries, costs = [*tries, *fresh], [*costs, *given]
        if len(fresh) == batch:
            search.tell(asked, np.where(np.isinf(given), FAILED, given))
    return Learning(np.array(tries), np.array(costs), search.mean)


METHODS = {"PI2": pi2, "PoWER": power, "CMA-ES": cma_es}


def main() -> None:
    practice = DigPractice()
    names = [f"p{k}" for k in range(9)] + [f"try {k}" for k in range(BUDGET)]
    lines = [
        "# the demonstrated dig, practised in sandy loam (heap 0): best parameters, costs of tries",
        f"# [1]; batches of {BATCH}, spread {SPREAD}; python tests/planning/write_practice.py",
        ",".join(["method", "seed", *names]),
    ]
    for name, method in METHODS.items():
        for seed in range(SEEDS):
            began = time.perf_counter()
            learnt = method(
                practice.costs, practice.start, SPREAD, batch=BATCH, budget=BUDGET, rng=seed
            )
            numbers = [f"{x:.4f}" for x in learnt.parameters] + [f"{x:.5f}" for x in learnt.costs]
            lines.append(",".join([name, str(seed), *numbers]))
            took = time.perf_counter() - began
            print(f"{name} {seed}: {learnt}, {learnt.gain:.0%}, {took:.0f} s", flush=True)
    FILE.parent.mkdir(exist_ok=True)
    FILE.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
