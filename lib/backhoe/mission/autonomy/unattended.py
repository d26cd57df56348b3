"""The stored missions that nobody watched: ten seeds, and each fault once."""

from __future__ import annotations

import csv
from pathlib import Path

FILE = Path(__file__).resolve().parents[4] / "data" / "autonomy" / "unattended.csv"

COUNTED = ("seed", "loads", "replans", "stopped")
NUMBERS = (
    *("soil", "into_truck", "digging", "loading", "cycle"),
    *("fill", "rate", "clearance", "margin", "astray"),
)
"""Of the report, as in `AutonomyScore`."""

COLUMNS = ("fault", *COUNTED, *NUMBERS, "ended")


def unattended(file: str | Path | None = None) -> list[dict[str, str | int | float]]:
    """Missions in PyBullet, one a row: three buckets without a fault, two with one.

    Args:
        file: as `tests/mission/autonomy/write_unattended.py` writes it; default `FILE`.

    Returns:
        Of each mission the values of `COLUMNS`; `fault` is "" for none, `stopped` 1 for a safe
        stop, and what a mission without a load does not have is NaN.

    Raises:
        FileNotFoundError: there is no such file.
    """
    with open(FILE if file is None else file, encoding="utf-8", newline="") as lines:
        rows = list(csv.DictReader(lines))
    kinds = dict.fromkeys(COUNTED, int) | dict.fromkeys(NUMBERS, float)
    return [{name: kinds.get(name, str)(row[name]) for name in COLUMNS} for row in rows]
