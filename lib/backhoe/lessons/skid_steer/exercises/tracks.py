"""Exercises 4.8 and 4.9: from a force and a moment to both tracks; who gives way at the limit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.vehicle.travel import limited, tractions


def _lever(lever: Callable[[float], float]) -> Callable[..., NDArray]:
    """The forces with the moment divided by something else than the gauge."""
    return lambda force, moment, gauge: tractions(force, moment, lever(gauge))


TRACTIONS = Exercise(
    number="4.8",
    title="A force and a moment for two tracks",
    reference=tractions,
    oracle="statics_of_two_forces",
    cases=lambda rng: [
        (force * ahead, moment * turn, gauge)
        for ahead, turn in ((1, 1), (1, 0), (0, 1))
        for force, moment, gauge in rng.uniform(
            (-9e4, -8e4, 1.2), (9e4, 8e4, 3.0), (14, 3)
        ).tolist()
    ],
    mistakes={
        "both tracks get the same, u_l = u_v + u_w: the left one takes the minus": (
            lambda *wish: tractions(*wish)[[1, 1]]
        ),
        "it would turn to the right: a positive moment pushes more on the right": (
            lambda *wish: tractions(*wish)[::-1]
        ),
        "a moment is no force: the lever of a track is missing": (_lever(lambda gauge: 1.0)),
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
        "half a moment is no force: divide by the gauge": _lever(lambda gauge: 2.0),
        "the lever multiplies the moment: a longer one needs less force": (
            _lever(lambda gauge: 1 / gauge)
        ),
        "each track gets the whole force; and a moment is no force: divide by the gauge": (
            lambda force, moment, gauge: tractions(2 * force, moment, 1.0)
        ),
        "each track gets the whole force, and the lever multiplies the moment": (
            lambda force, moment, gauge: tractions(2 * force, moment, 2 / gauge)
        ),
        "a track that pulls back has a negative force": lambda *wish: np.abs(tractions(*wish)),
        "only the moment is shared out: half of the force goes to each track as well": (
            lambda force, moment, gauge: tractions(0.0, moment, gauge)
        ),
        "only the force is shared out: the moment pushes the right ahead and the left back": (
            lambda force, moment, gauge: tractions(force, 0.0, gauge)
        ),
        "both turn signs: it would drive and turn the other way": lambda *wish: -tractions(*wish),
        "all of the moment is on one track: it would push the vehicle as well": (
            lambda force, moment, gauge: (
                tractions(force, 0.0, gauge) + np.array([0.0, 2 * moment / gauge])
            )
        ),
    },
    hints=(
        "Two unknowns, two equations: the sum is the force, the difference times l/2 the moment.",
        "left + right = force and (right - left) gauge / 2 = moment: solve for left and right.",
    ),
    tested_on="42 forces and moments both ways, together and alone, on any gauge",
)


def _wishes(rng: np.random.Generator) -> list[tuple]:
    """Wishes within the limit and beyond it, of one, of the other, of both, and of none."""
    cases = []
    for _ in range(60):
        limit = float(rng.uniform(5e4, 2e5))
        u_v, u_omega = rng.choice([0.0, 0.3, 0.8, 1.0, 1.7], 2) * rng.choice([-1, 1], 2) * limit
        cases.append((float(u_v), float(u_omega), limit))
    return cases


def _each_track(u_v: float, u_omega: float, limit: float) -> NDArray:
    left, right = np.clip([u_v - u_omega, u_v + u_omega], -limit, limit)
    return np.array([(left + right) / 2, (right - left) / 2])


def _scaled(u_v: float, u_omega: float, limit: float) -> NDArray:
    return np.array([u_v, u_omega]) * min(1.0, limit / max(abs(u_v) + abs(u_omega), 1e-9))


def _one_sided(u_v: float, u_omega: float, limit: float) -> NDArray:
    turn = min(u_omega, limit)
    return np.array([min(u_v, limit - abs(turn)), turn])


def _without_abs(u_v: float, u_omega: float, limit: float) -> NDArray:
    turn = min(max(u_omega, -limit), limit)
    return np.array([min(max(u_v, -(limit - turn)), limit - turn), turn])


def _left_of_the_wish(u_v: float, u_omega: float, limit: float) -> NDArray:
    left = limit - abs(u_omega)
    return np.array([min(max(u_v, -left), left), limited(u_v, u_omega, limit)[1]])


def _all_or_nothing(u_v: float, u_omega: float, limit: float) -> NDArray:
    fits = abs(u_v) + abs(u_omega) <= limit
    return np.array([u_v if fits else 0.0, limited(u_v, u_omega, limit)[1]])


LIMITED = Exercise(
    number="4.9",
    title="The turn first",
    reference=limited,
    oracle="two_linear_programmes",
    cases=_wishes,
    mistakes={
        "each track is cut alone: where both wishes are large the turn is lost": _each_track,
        "both shrink by one factor: the turn has all it can get first": _scaled,
        "the speed comes first: give the turn its own, and the speed what is left": (
            lambda u_v, u_omega, limit: limited(u_omega, u_v, limit)[::-1]
        ),
        "each wish is cut to the limit: together a track would give twice as much": (
            lambda u_v, u_omega, limit: np.clip([u_v, u_omega], -limit, limit)
        ),
        "the turn is cut, the speed is not: no track gives more than the limit": (
            lambda u_v, u_omega, limit: np.array([u_v, limited(u_v, u_omega, limit)[1]])
        ),
        "only what is too large is cut: a track pulls back no harder than the limit, either": (
            _one_sided
        ),
        "a turn to the right needs as much as one to the left: what is left is limit - |turn|": (
            _without_abs
        ),
        "what is left goes below zero: cut the turn first, then see what it leaves": (
            _left_of_the_wish
        ),
        "the speed gets all that is left, even where it asks for less": (
            lambda u_v, u_omega, limit: limited(9 * limit, u_omega, limit)
        ),
        "backwards is a wish, too: what is left goes from minus to plus": (
            lambda u_v, u_omega, limit: limited(max(u_v, 0.0), u_omega, limit)
        ),
        "these are the tracks, each cut alone: u_v and u_omega are asked, the turn first": (
            lambda u_v, u_omega, limit: np.clip([u_v - u_omega, u_v + u_omega], -limit, limit)
        ),
        "what is left is limit - |turn given|, and not limit - turn wanted": (
            lambda u_v, u_omega, limit: np.array(
                [np.clip(u_v, u_omega - limit, limit - u_omega), np.clip(u_omega, -limit, limit)]
            )
        ),
        "the speed is dropped where it does not fit: it may have what is left": _all_or_nothing,
        "the speed gets nothing at all: it may have what the turn leaves": (
            lambda *wish: limited(*wish) * [0, 1]
        ),
        "these are the forces of the left and right track: u_v and u_omega are asked": (
            lambda *wish: limited(*wish) @ [[1, 1], [-1, 1]]
        ),
        "u_v comes first, then u_omega": lambda *wish: limited(*wish)[::-1],
        "nothing is cut: no track gives more than the limit": (
            lambda u_v, u_omega, limit: np.array([u_v, u_omega])
        ),
        "each has half of the limit: the turn may have all of it": (
            lambda u_v, u_omega, limit: np.clip([u_v, u_omega], -limit / 2, limit / 2)
        ),
        "a wish for less than nothing is a wish backwards, or to the right: keep its sign": (
            lambda *wish: np.abs(limited(*wish))
        ),
    },
    hints=(
        "np.clip(u_omega, -limit, limit) is what the turn gets. What does that leave a track?",
        "The tracks give u_v - u_omega and u_v + u_omega: |u_v| may be limit - |u_omega given|.",
    ),
    tested_on="60 wishes within and beyond the limit, of either, of both and of none",
)
