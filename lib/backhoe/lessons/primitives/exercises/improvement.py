"""Exercises of lesson 10c: a push felt by the joints, weights of tries, an update of one's own."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.contact import contact_jacobian, push_from
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE
from backhoe.planning.improve import pi2_weights

__all__ = ["EXERCISES"]


def push(q: NDArray, given: NDArray, needed: NDArray) -> NDArray:
    """What the motion needs less what the actuators give is the push's share: J^T w."""
    return push_from(q, needed - given)


def _postures(rng: np.random.Generator) -> list[tuple]:
    room = BACKHOE.upper - BACKHOE.lower
    q = BACKHOE.lower + room * rng.uniform(0.15, 0.85, (20, 4))
    return [(row, *(1e4 * rng.normal(size=(2, 4)))) for row in q]


def _solved(how: Callable[[NDArray, NDArray], NDArray]) -> Callable:
    return lambda q, given, needed: how(contact_jacobian(q), needed - given)


FEELING = Exercise(
    number="10.8",
    title="What pushes?",
    reference=push,
    cases=_postures,
    oracle="its_work_is_that_of_the_joints",
    mistakes={
        "the sign: the push does what the motion needs and the actuators do not give": (
            lambda q, given, needed: push(q, needed, given)
        ),
        "J without its transpose: it turns joint speeds into the tip's, torques need J^T": _solved(
            np.linalg.solve
        ),
        "multiplied by J^T: that makes torques of a push; solve J^T w = tau": _solved(
            lambda J, tau: J.T @ tau
        ),
        "multiplied by J: solve J^T w = tau instead": _solved(lambda J, tau: J @ tau),
        "all that the actuators give, as if the arm had no weight: take off what it needs": (
            lambda q, given, needed: push_from(q, -given)
        ),
        "only what the motion needs: what the actuators give is missing": (
            lambda q, given, needed: push_from(q, needed)
        ),
        "a force alone: the soil also turns the bucket, take all four rows of J": _solved(
            lambda J, tau: np.r_[np.linalg.lstsq(J[:3].T, tau, rcond=None)[0], 0.0]
        ),
    },
    hints=(
        "The equation of motion with a push: needed = given + J^T w.",
        "w = np.linalg.solve(contact_jacobian(q).T, needed - given).",
    ),
    tested_on="20 postures with torques of some 10 kN m",
)


def _batches(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(24):
        costs = 10.0 ** (k % 5 - 2) * rng.uniform(0.2, 3.0, 4 + k % 9)
        if k % 3 == 1:
            costs[rng.integers(len(costs))] = np.inf
        if k % 4 == 2:
            costs -= costs[np.isfinite(costs)][0]
        cases.append((costs, float(rng.choice([0.7, 4.5, 10.0, 30.5]))))
    return cases


def _shares(raw: Callable[[NDArray, float], NDArray]) -> Callable:
    """Normalised weights of the tries that did not fail, from their costs less the least."""

    def weights(costs, hardness):
        done = np.isfinite(costs)
        found = np.zeros(len(costs))
        found[done] = raw(costs[done], hardness)
        return found / found.sum()

    return weights


def _range(c: NDArray) -> float:
    return c.max() - c.min()


WEIGHTS = Exercise(
    number="10.9",
    title="Weights of PI2",
    reference=pi2_weights,
    cases=_batches,
    oracle="logarithms_of_the_shares",
    mistakes={
        "the sign: the dearest try weighs most": _shares(
            lambda c, h: np.exp(h * (c - c.max()) / _range(c))
        ),
        "not divided by their sum: the weights are shares": (
            lambda costs, h: pi2_weights(costs, h) / pi2_weights(costs, h).max()
        ),
        "the range is missing: with costs of another unit the weights would change": _shares(
            lambda c, h: np.exp(-h * (c - c.min()))
        ),
        "divided by the largest cost, not by the range: where costs begin must not matter": _shares(
            lambda c, h: np.exp(-h * (c - c.min()) / np.abs(c).max())
        ),
        "h divides: a large h shall make the best weigh more": _shares(
            lambda c, h: np.exp(-(c - c.min()) / _range(c) / h)
        ),
        "all weights alike: that is the plain mean, which learns nothing": _shares(
            lambda c, h: np.ones(len(c))
        ),
        "only the best counts: that is one try, not an average": _shares(
            lambda c, h: (c == c.min()).astype(float)
        ),
        "h is missing: the best weighs only e times the worst": _shares(
            lambda c, h: np.exp(-(c - c.min()) / _range(c))
        ),
        "a straight line instead of the exponential": _shares(lambda c, h: c.max() - c),
        "failed tries (inf) are counted in the range: leave them out, their weight is 0": (
            lambda costs, h: (
                np.exp(-h * (costs - costs.min()) / (costs.max() - costs.min()))
                / np.sum(np.exp(-h * (costs - costs.min()) / (costs.max() - costs.min())))
            )
        ),
    },
    hints=(
        "Least and largest among np.isfinite(costs); c = (costs - least) / (largest - least).",
        "w = np.exp(-hardness * c); it is 0 where c is inf; return w / w.sum().",
    ),
    tested_on="24 batches of costs in units from 0.01 to 100, eight with a failed try",
)


def update(tries: NDArray, costs: NDArray) -> NDArray:
    """The average of PI2."""
    return pi2_weights(costs) @ tries


def _practice(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(20):
        mean, lowest = rng.normal(size=(2, 9))
        tries = mean + 0.3 * rng.normal(size=(10, 9))
        costs = np.sum((tries - lowest) ** 2, axis=1)
        if k % 4 == 1:
            costs[rng.integers(10)] = np.inf
        cases.append((tries, costs))
    return cases


def _improves(answer: NDArray, reference: NDArray, tries: NDArray, costs: NDArray) -> str | None:
    if np.shape(answer) != (9,) or not np.isfinite(answer).all():
        return "give nine finite parameters; a failed try has the cost inf"
    if (answer < tries.min(axis=0) - 1e-9).any() or (answer > tries.max(axis=0) + 1e-9).any():
        return "outside of what was tried: nobody knows what it costs there"
    done = np.isfinite(costs)
    slope = (costs[done] - costs[done].mean()) @ (tries[done] - tries[done].mean(axis=0))
    gone = -slope @ (answer - tries[done].mean(axis=0))
    if gone < 0.3 * -slope @ (reference - tries[done].mean(axis=0)):
        return "it hardly goes to where the tries were cheap: weigh them by their costs"
    return None


UPDATE = Exercise(
    number="10.10",
    title="Your update in the machine",
    reference=update,
    cases=_practice,
    oracle="a_mean_with_weights_from_logarithms",
    mistakes={
        "the plain mean of the tries: costs are not used": lambda tries, costs: tries.mean(axis=0),
        "the dearest tries weigh most: the sign": (
            lambda tries, costs: pi2_weights(np.where(np.isinf(costs), np.inf, -costs)) @ tries
        ),
        "weighed by the costs themselves: dear tries count more": (
            lambda tries, costs: (
                np.nan_to_num(costs, posinf=0.0) @ tries / np.nan_to_num(costs, posinf=0.0).sum()
            )
        ),
        "the weights are not divided by their sum": (
            lambda tries, costs: pi2_weights(costs) / pi2_weights(costs).max() @ tries
        ),
        "that is the change, not the next mean": (
            lambda tries, costs: pi2_weights(costs) @ tries - tries.mean(axis=0)
        ),
        "the worst try of the batch": (
            lambda tries, costs: tries[np.where(np.isinf(costs), -np.inf, costs).argmax()]
        ),
    },
    hints=(
        "my_weights(costs, 10) @ tries is one; ranks instead of costs are another.",
        "Whatever you weigh by: finite costs only, cheap tries most, divided by the sum.",
    ),
    compare=_improves,
    tested_on="20 batches of ten tries with nine parameters, five with a failed one",
)

EXERCISES = (FEELING, WEIGHTS, UPDATE)
