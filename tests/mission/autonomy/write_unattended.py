"""`python tests/mission/autonomy/write_unattended.py` lets the machine work alone, and writes what
came of it: ten seeds and each fault once, in PyBullet, to data/autonomy/unattended.csv.

About six minutes on one core. `python ... 3 "lost scan"` prints those rows only.
"""

from __future__ import annotations

import csv
import sys

from backhoe.mission import autonomy
from backhoe.mission.autonomy.unattended import COLUMNS, FILE, NUMBERS

SEEDS, LOADS, LOADS_WITH_A_FAULT = 10, 3, 2


def row(fault: str, seed: int) -> dict[str, object]:
    """One mission with a fault, or with none: ""."""
    ordered = LOADS_WITH_A_FAULT if fault else LOADS
    run = autonomy.run(loads=ordered, seed=seed, fault=fault or None, backend="pybullet")
    score = autonomy.report(run)
    numbers = {name: f"{getattr(score, name):.3f}" for name in NUMBERS}
    counted = {"loads": score.loads, "replans": score.replans, "stopped": score.stops}
    return {"fault": fault, "seed": seed, **counted, **numbers, "ended": score.ended}


def main(wanted: list[str]) -> None:
    jobs = [("", seed) for seed in range(SEEDS)] + [(fault, 0) for fault in autonomy.FAULTS]
    if wanted:
        jobs = [job for job in jobs if (job[0] or str(job[1])) in wanted]
    FILE.parent.mkdir(exist_ok=True)
    with open(sys.stdout.fileno() if wanted else FILE, "w", encoding="utf-8", newline="") as out:
        table = csv.DictWriter(out, COLUMNS, lineterminator="\n")
        table.writeheader()
        for job in jobs:
            table.writerow(row(*job))
            out.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
