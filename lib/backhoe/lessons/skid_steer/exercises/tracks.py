"""Exercise 4.8: from a force and a moment to the forces of both tracks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise


def tractions(force: float, moment: float, gauge: float) -> NDArray:
    """Forces of the left and right track that add up to a force and a yaw moment [N]."""
    difference = moment / gauge
    return np.array([force / 2 - difference, force / 2 + difference])


def _lever(lever: Callable[[float], float]) -> Callable[..., NDArray]:
    """The forces with the moment divided by something else than the gauge."""
    return lambda force, moment, gauge: tractions(force, moment, lever(gauge))


TRACTIONS = Exercise(
    number="4.8",
    title="A force and a moment for two tracks",
    reference=tractions,
    oracle="statics_of_two_forces",
    cases=lambda rng: [tuple(rng.uniform((-9e4, -8e4, 1.2), (9e4, 8e4, 3.0))) for _ in range(40)],
    mistakes={
        "both tracks get the same, u_l = u_v + u_w: the left one takes the minus": (
            lambda *wish: tractions(*wish)[[1, 1]]
        ),
        "it would turn to the right: a positive moment pushes more on the right": (
            lambda *wish: tractions(*wish)[::-1]
        ),
        "that is (3.35) with a moment for a force: the lever of a track is missing": (
            _lever(lambda gauge: 1.0)
        ),
        "the lever is right, but both sides make the moment: each has half of it": (
            _lever(lambda gauge: gauge / 2)
        ),
        "half of the moment is missing: each side makes half of it, at a lever of half the gauge": (
            _lever(lambda gauge: 2 * gauge)
        ),
        "a longer lever needs less force: divide the moment by it": (
            _lever(lambda gauge: 2 / gauge)
        ),
        "each track gets the whole force, so together they push twice as hard": (
            lambda force, moment, gauge: tractions(2 * force, moment, gauge)
        ),
        "both sums come out twice as large: two tracks share the force and the moment": (
            lambda *wish: 2 * tractions(*wish)
        ),
    },
    hints=(
        "Two unknowns, two equations: the sum is the force, the difference times l/2 the moment.",
        "left + right = force and (right - left) gauge / 2 = moment: solve for left and right.",
    ),
    tested_on="40 random forces, moments and gauges",
)
