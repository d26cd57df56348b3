"""Trackers side by side on the same paths, as in D'Angelo's Tables 5.1, 5.2 and Fig. 6.3.

Each tracker drives each path from the same start on a fresh plant. What comes out is a table whose
best values are marked, as the source marks them in bold.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import choice
from backhoe.vehicle.tracking.assessment import Assessment, assess
from backhoe.vehicle.tracking.follow import Follow, follow
from backhoe.vehicle.tracking.metrics import Metrics
from backhoe.vehicle.tracking.path import Path
from backhoe.vehicle.tracking.protocol import Plant, Tracker


@dataclass(frozen=True, eq=False)
class Comparison:
    """Runs of several trackers on several paths.

    Attributes:
        trackers, paths: their names, in the order given.
        values: field of `Assessment` -> its numbers in their own units, shape (paths, trackers).
        follows: (tracker, path) -> the run.
    """

    trackers: tuple[str, ...]
    paths: tuple[str, ...]
    values: dict[str, NDArray]
    follows: dict[tuple[str, str], Follow]

    def best(self, field: str, decimals: int = 3) -> NDArray:
        """Which trackers have the best value on each path, to `decimals` of the field's own unit.

        The best d_ratio is the nearest to 1, the best lag the nearest to 0, else the least counts.
        Shape (paths, trackers), true for the best.
        """
        bad = np.round(_badness(field, self._field(field)), decimals)
        return bad == np.min(bad, axis=1, keepdims=True)

    def table(self, fields: Sequence[str] = Metrics._fields, decimals: int = 3) -> str:
        """The values as text, a line for each path and tracker, the best on each path marked *.

        Args:
            fields: names of Assessment's fields, the columns.
            decimals: digits after the point.

        Raises:
            ValueError: an unknown field; the message lists those that there are.
        """
        marks = {field: self.best(field, decimals) for field in fields}
        width = max(len(name) for name in (*self.paths, "path"))
        wide = max(len(name) for name in (*self.trackers, "tracker"))
        columns = [max(len(field), decimals + 5) for field in fields]
        titles = (f"{field:>{size}}" for field, size in zip(fields, columns, strict=True))
        lines = ["  ".join((f"{'path':<{width}}", f"{'tracker':<{wide}}", *titles))]
        for i, path in enumerate(self.paths):
            for j, tracker in enumerate(self.trackers):
                cells = [
                    f"{_cell(self.values[field][i, j], marks[field][i, j], decimals):>{size}}"
                    for field, size in zip(fields, columns, strict=True)
                ]
                lines.append("  ".join((f"{path:<{width}}", f"{tracker:<{wide}}", *cells)).rstrip())
        return "\n".join(lines)

    def _field(self, field: str) -> NDArray:
        return self.values[choice(field, "field", self.values)]


def compare(
    trackers: Mapping[str, Tracker],
    paths: Mapping[str, Path],
    plant: Callable[[], Plant],
    *,
    mode: str = "path",
    **options: object,
) -> Comparison:
    """Drive every path with every tracker.

    Args:
        trackers: name -> tracker. Its `reset()` is called before each run.
        paths: name -> path, with times in trajectory mode.
        plant: function without arguments that gives a fresh plant at the start.
        mode: "path" or "trajectory".
        options: arguments of `follow`: arrival, time_limit, limits, speed, period.

    Returns:
        The Comparison.

    Raises:
        ValueError: no trackers or no paths, or as `follow` says.
        TypeError: plant is not callable, or as `follow` says.
    """
    if not trackers or not paths:
        raise ValueError("compare needs at least one tracker and one path, by name")
    if not callable(plant):
        raise TypeError(f"plant must be a function that makes a plant, got {plant!r}")
    follows = {}
    for path_name, path in paths.items():
        for name, tracker in trackers.items():
            run = follow(tracker, plant(), path, mode=mode, name=name, **options)
            follows[name, path_name] = run
    marks = {key: assess(run) for key, run in follows.items()}
    values = {
        field: np.array(
            [[getattr(marks[name, path], field) for name in trackers] for path in paths]
        )
        for field in Assessment._fields
    }
    return Comparison(tuple(trackers), tuple(paths), values, follows)


def _badness(field: str, values: NDArray) -> NDArray:
    """How far values of a metric are from the ideal: |d_ratio - 1|, |lag|, else the value."""
    if field == "d_ratio":
        return np.abs(values - 1)
    return np.abs(values)


def _cell(value: float, best: bool, decimals: int) -> str:
    return f"{value:.{decimals}f}{'*' if best else ' '}"
