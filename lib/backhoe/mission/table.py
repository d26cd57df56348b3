"""How a score is printed: a row a number, yours beside the library's."""

from __future__ import annotations

from collections.abc import Callable

MARGIN_ROWS = [
    ("least margin [m]", "{:.2f}", lambda score: round(score.margin, 2) + 0.0),
    ("  that was at [s]", "{:.1f}", lambda score: score.margin_time),
]
"""Rows of every score that has `margin` [m] and `margin_time` [s]."""


def table(score: object, rows: list[tuple[str, str, Callable]]) -> str:
    """A score as text, its `reference` beside it if it has one.

    Args:
        score: with `swapped`, the names of the student's parts, and `reference`, a score or None.
        rows: label with unit, format, and what gives the number of a score.
    """
    columns = [score] if score.reference is None else [score, score.reference]
    beside = "library" if score.swapped else "on truth"
    heads = ["yours" if score.swapped else "library", beside][: len(columns)]
    parts = ", ".join(score.swapped) or "none"
    lines = [f"swapped in: {parts}", " " * 24 + "".join(f"{head:>10}" for head in heads)]
    lines += [
        f"{label:<24}" + "".join(f"{form.format(value(column)):>10}" for column in columns)
        for label, form, value in rows
    ]
    return "\n".join(lines)
