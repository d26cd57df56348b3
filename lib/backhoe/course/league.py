"""A table of who does best, kept in a small file beside the notebook: for this machine alone."""

from __future__ import annotations

import json
from collections.abc import Mapping
from datetime import date
from pathlib import Path

from backhoe.basics.inputs import instance, number

FILE = "league.json"


def league(
    built_in: Mapping[str, float],
    name: str | None = None,
    score: float | None = None,
    folder: str | Path = ".",
) -> str:
    """Enter a score, and the table, best first; of each name the best score counts.

    Args:
        built_in: names and scores that stand in the table without having been entered.
        name: who enters; None enters nothing, and shows the built-in names alone.
        score: theirs; the higher the better.
        folder: where the file is; what cannot be read there counts as empty.

    Raises:
        TypeError: the name is no text.
        ValueError: a score that is no finite number.
        OSError: the file cannot be written.
    """
    place, entered = Path(folder) / FILE, {}
    if name is not None:
        instance(name, "name", str)
        score = number(score, "score")
        entered = _read(place)
        if name not in entered or entered[name]["score"] < score:
            entered[name] = {"score": score, "date": date.today().isoformat()}
            place.write_text(json.dumps(entered, indent=1), encoding="utf-8")
    rows = {**{who: one["score"] for who, one in entered.items()}, **built_in}
    order = sorted(rows, key=rows.get, reverse=True)
    return "\n".join(f"{rank}. {who:24s} {rows[who]:.2f}" for rank, who in enumerate(order, 1))


def _read(place: Path) -> dict[str, dict]:
    try:
        found = json.loads(place.read_text(encoding="utf-8"))
        return {str(who): {"score": float(one["score"]), **one} for who, one in found.items()}
    except (OSError, ValueError, TypeError, AttributeError, KeyError):
        return {}
