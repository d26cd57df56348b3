"""What planners ask: is this place free, is this edge free, and is there time left?"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from time import perf_counter

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import (
    function,
    instance,
    number,
    numbers,
    positive,
    short,
    truths,
    whole,
)

FAR = 1e9
"""Largest coordinate that is accepted."""

IsFree = Callable[[NDArray], NDArray]
"""Places, shape (n, D), to truth values, shape (n,): whether nothing is hit there."""


class NoPath(RuntimeError):
    """There is no way, or none was found with the samples or in the time that were given."""


@dataclass
class Log:
    """What a search looked at: give a new one to a planner, and it is filled.

    Attributes:
        points: places that were reached, shape (n, D), in the space's own units.
        edges: pairs of them that were joined, shape (m, 2), indices.
        evaluations: places that the checker was asked about.
        best: (evaluations, length) of each way that was found, the last one returned.
    """

    points: NDArray = field(default_factory=lambda: np.empty((0, 0)))
    edges: NDArray = field(default_factory=lambda: np.empty((0, 2), int))
    evaluations: int = 0
    best: list[tuple[int, float]] = field(default_factory=list)


class Checker:
    """`is_free` with a resolution and a time limit, and its answers checked.

    Args:
        is_free: see `IsFree`.
        resolution: largest distance between two places of an edge that are looked at.
        time_limit: from now [s]. A call under way is waited for, so a slow checker is asked about
            few places at once.
        log: counts the places.
    """

    def __init__(
        self, is_free: IsFree, resolution: float, time_limit: float, log: Log | None = None
    ) -> None:
        self.is_free = function(is_free, "is_free", "is_free(points (n, D)) -> truth values (n,)")
        self.resolution = positive(resolution, "resolution")
        self.time_limit = number(time_limit, "time_limit", "s", above=0.0, most=1e6)
        self.log = Log() if log is None else instance(log, "log", Log)
        self._end = perf_counter() + self.time_limit
        self._cost = self.time_limit  # of a place [s], unknown at first: one alone

    def on_time(self) -> float:
        """Time that is left [s]; NoPath when there is none."""
        left = self._end - perf_counter()
        if left <= 0:
            raise NoPath(f"no way found within time_limit, {self.time_limit:g} s")
        return left

    def free(self, points: NDArray, *, until_hit: bool = False) -> NDArray:
        """Of each place, shape (n, D), whether it is free; after the first hit perhaps False."""
        found, done = np.zeros(len(points), bool), 0
        while done < len(points):
            left = self.on_time()
            part = points[done : done + max(1, int(left / self._cost))]
            found[done : done + len(part)] = answer = self._ask(part)
            self._cost = max((left - (self._end - perf_counter())) / len(part), 1e-9)
            done += len(part)
            if until_hit and not answer.all():
                break
        return found

    def edge(self, a: NDArray, b: NDArray) -> bool:
        """Whether all places looked at between a (itself known to be free) and b are free."""
        return bool(self.free(between(a, b, self.resolution), until_hit=True).all())

    def edges(self, starts: NDArray, ends: NDArray) -> NDArray:
        """The same of many edges, shape (k, D) each, in one call of the checker."""
        if not len(starts):
            return np.empty(0, bool)
        ways = [between(a, b, self.resolution) for a, b in zip(starts, ends, strict=True)]
        firsts = np.cumsum([0, *map(len, ways[:-1])])
        return np.logical_and.reduceat(self.free(np.concatenate(ways)), firsts)

    def _ask(self, points: NDArray) -> NDArray:
        answer = answer_of(self.is_free, "is_free", points.copy())
        answer = truths(answer, "the answer of is_free", (len(points),))
        self.log.evaluations += len(points)
        return answer


class Problem:
    """A start, a goal and a box of places between `lower` and `upper`, checked; for all planners.

    Attributes:
        step: longest edge of a tree, a tenth of the box's diagonal if it is not given;
        checker: with the resolution given, or a hundredth of the diagonal.

    Raises:
        ValueError: shapes, bounds the wrong way round, a start or goal outside or in collision.
        NoPath: no time left.
    """

    def __init__(
        self,
        start: ArrayLike,
        goal: ArrayLike,
        is_free: IsFree,
        lower: ArrayLike,
        upper: ArrayLike,
        step: float | None,
        resolution: float | None,
        budget: int,
        time_limit: float,
        log: Log | None,
    ) -> None:
        self.start = numbers(start, "start", ("D",), within=FAR)
        D = len(self.start)
        self.goal = numbers(goal, "goal", (D,), meaning="as start", within=FAR)
        each = "a bound for each coordinate of start"
        self.lower = numbers(lower, "lower", (D,), meaning=each, within=FAR)
        self.upper = numbers(upper, "upper", (D,), meaning=each, within=FAR)
        if (self.lower >= self.upper).any():
            raise ValueError(f"lower must be below upper, got {self.lower} and {self.upper}")
        diagonal = float(np.linalg.norm(self.upper - self.lower))
        step = diagonal / 10 if step is None else step
        self.step = number(step, "step", least=diagonal / 1e4)
        self.budget = whole(budget, "budget", least=1, most=10**7)
        resolution = diagonal / 100 if resolution is None else resolution
        number(resolution, "resolution", above=0.0, least=diagonal / 1e6)
        self.checker = Checker(is_free, resolution, time_limit, log)
        for name, place in (("start", self.start), ("goal", self.goal)):
            if (place < self.lower).any() or (place > self.upper).any():
                raise ValueError(f"{name} must be between lower and upper, got {place}")
            if not self.checker.free(place[None])[0]:
                raise ValueError(f"{name} must be free, {place} is in collision")


def answer_of(asked: Callable, name: str, *given: object) -> object:
    """What a function that was handed in says; a ValueError with its name where it raises."""
    try:
        return asked(*given)
    except Exception as error:
        raise ValueError(
            f"{name} must answer, it raised {type(error).__name__}: {error} "
            f"when asked about {', '.join(map(short, given))}"
        ) from error


def between(a: NDArray, b: NDArray, resolution: float) -> NDArray:
    """Places from a to b, without a and with b, no further apart than that, shape (n, D)."""
    n = max(1, int(np.ceil(np.linalg.norm(b - a) / resolution)))
    return a + np.arange(1, n + 1)[:, None] / n * (b - a)


def path_length(path: ArrayLike) -> float:
    """Length of a path of straight edges, shape (n, D), in the space's own units."""
    path = numbers(path, "path", ("n", "D"), meaning="places in a row", within=FAR)
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
