"""Downhill in a potential field: pulled by the goal, pushed by obstacles, and sometimes caught."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import function, numbers, positive, whole
from backhoe.planning.search.checker import answer_of


class Descent(NamedTuple):
    """Where a potential field led.

    Attributes:
        path: from the start on, shape (n, D), in the space's own units.
        end: "goal"; "minimum", where no short step leads down and the goal is elsewhere (a local
            minimum, or a saddle); or "budget", still on its way.
        values: the potential along the path, shape (n,) [own units squared]; it falls.
        evaluations: places where the distance was asked for.
    """

    path: NDArray
    end: str
    values: NDArray
    evaluations: int


def potential(
    start: ArrayLike,
    goal: ArrayLike,
    distance: Callable[[NDArray], tuple[NDArray, NDArray]],
    *,
    reach: float = 1.0,
    push: float = 1.0,
    step: float = 0.05,
    budget: int = 5000,
) -> Descent:
    """Follow the field's slope down from the start, in steps that each lower it.

    The potential is |x - goal|^2 / 2, and push (1/d - 1/reach)^2 / 2 more within `reach` of an
    obstacle, d away from it. Source: Khatib 1986.

    Args:
        start, goal: shape (D,), in the space's own units.
        distance: places (n, D) to distances (n,) to the nearest obstacle, and their gradients
            (n, D), as `perception.distance_field.DistanceField.query`.
        reach: how far an obstacle is felt.
        push: its strength.
        step: the longest step.
        budget: steps at most.

    Raises:
        ValueError: shapes; a start or goal in collision, where d is not above 0.
    """
    x = numbers(start, "start", ("D",), within=1e9)
    goal = numbers(goal, "goal", x.shape, meaning="as start", within=1e9)
    function(distance, "distance", "distance(points (n, D)) -> distances (n,), gradients (n, D)")
    reach, push, step = positive(reach, "reach"), positive(push, "push"), positive(step, "step")
    asked = 0

    def field(at: NDArray) -> tuple[float, NDArray]:
        nonlocal asked
        asked += 1
        gap, away = answer_of(lambda places: tuple(distance(places)), "distance", at[None].copy())
        d = float(numbers(gap, "distances of distance", (1,), finite=False)[0])
        away = numbers(away, "gradients of distance", (1, len(at)))[0]
        if d <= 0:
            return np.inf, away
        felt = max(1 / d - 1 / reach, 0.0)
        value = ((at - goal) @ (at - goal) + push * felt**2) / 2
        return value, at - goal - push * felt / d**2 * away

    for name, place in (("start", x), ("goal", goal)):
        if field(place)[0] == np.inf:
            raise ValueError(f"{name} must be free, {place} is in collision")
    value, slope = field(x)
    path, values, end = [x], [value], "budget"
    for _ in range(whole(budget, "budget", least=1, most=10**6)):
        if np.linalg.norm(x - goal) < step:
            end = "goal"
            break
        length = step
        while length > 1e-6 * step:
            new = x - length * slope / max(np.linalg.norm(slope), 1e-300)
            new_value, new_slope = field(new)
            if new_value < value:
                break
            length /= 2
        else:
            end = "minimum"
            break
        x, value, slope = new, new_value, new_slope
        path.append(x), values.append(value)
    return Descent(np.array(path), end, np.array(values), asked)
