"""Formulas of Mastalli 2013, chapter 6 and appendix B, as printed. Not for use.

The appendix of chapter 10 tests them; `backhoe.planning.dmp` has what they should be.
"""

from __future__ import annotations

from math import exp

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, numbers, positive

__all__ = ["best_action", "root_of_the_kernel", "tau_and_alpha"]


def tau_and_alpha(tau: float, seconds: float) -> tuple[float, float]:
    """(6.11): for another duration tau is kept and alpha is 5.25 tau / t_e.

    Args:
        tau: as learnt [s].
        seconds: the new duration t_e [s].

    Raises:
        ValueError: not positive numbers.
    """
    tau = positive(tau, "tau", "s")
    return tau, 5.25 / positive(seconds, "seconds", "s") * tau


def root_of_the_kernel(h: float, d: float) -> float:
    """Below (B.5): psi = sqrt(K) = exp(-h d), for K = exp(-h d^2).

    Args:
        h: sharpness, per square of the unit of d.
        d: distance [any unit].

    Raises:
        ValueError: negative numbers.
    """
    return exp(-not_negative(h, "h") * not_negative(d, "d"))


def best_action(rewards: ArrayLike, chances: ArrayLike) -> int:
    """(6.2): the action with the largest reward that can come, for there is no expectation in it.

    Args:
        rewards: of each action and outcome, shape (actions, outcomes) [1].
        chances: of the outcomes, same shape; not used [1].

    Raises:
        ValueError: other shapes.
    """
    rewards: NDArray = numbers(rewards, "rewards", ("actions", "outcomes"))
    possible = numbers(chances, "chances", rewards.shape) > 0
    return int(np.where(possible, rewards, -np.inf).max(axis=1).argmax())
