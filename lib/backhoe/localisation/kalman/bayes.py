"""The Bayes filter over finitely many states: nothing linear, nothing Gaussian, only sums.

Source: Mastalli 2013, eqs. (4.4)-(4.7), with the marginals P(x_k | z) where (4.6) and (4.7) print
the joint P(x_1:k | z).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers

_ROUNDING = 1e-9


class DiscreteBayesFilter:
    """Probability of each of n states.

    Args:
        belief: P(x_0), shape (n,), of sum 1 [1].

    Attributes:
        belief: P(x_k | z_1:k), shape (n,) [1].

    Raises:
        ValueError: negative, or another sum.
    """

    def __init__(self, belief: ArrayLike) -> None:
        meaning = "the probability of each state"
        self.belief = distribution(numbers(belief, "belief", ("n",), meaning=meaning), "belief")

    def predict(self, transition: ArrayLike) -> None:
        """Belief after a move: the sum over x_k-1 of P(x_k | x_k-1) P(x_k-1 | z_1:k-1).

        Args:
            transition: element [i, j] is P(x_k = i | x_k-1 = j), shape (n, n) [1]; columns of
                sum 1.

        Raises:
            ValueError: another shape, negative, or columns of another sum.
        """
        n = len(self.belief)
        transition = numbers(transition, "transition", (n, n))
        self.belief = distribution(transition, "each column of transition") @ self.belief

    def update(self, likelihood: ArrayLike) -> float:
        """Belief after a measurement: P(z_k | x_k) P(x_k | z_1:k-1) / P(z_k | z_1:k-1).

        Args:
            likelihood: P(z_k | x_k) of the z_k that came, for each state, shape (n,) [1].

        Returns:
            The evidence P(z_k | z_1:k-1).

        Raises:
            ValueError: another shape, negative, or impossible in every state that is believed in.
        """
        likelihood = numbers(likelihood, "likelihood", self.belief.shape)
        if (likelihood < 0).any():
            raise ValueError(f"likelihood must not be negative, got {likelihood.tolist()}")
        joint = likelihood * self.belief
        evidence = float(joint.sum())
        if not evidence > 0:
            raise ValueError("the measurement is impossible in every state that has probability")
        self.belief = joint / evidence
        return evidence


def distribution(p: NDArray, name: str) -> NDArray:
    """A copy of p, shape (n,) or (n, columns) [1], if it is not negative and sums to 1."""
    total = p.sum(axis=0)
    if (p < 0).any() or np.abs(total - 1).max() > _ROUNDING:
        raise ValueError(f"{name} must not be negative and sum to 1, got sum {total.tolist()}")
    return np.array(p)
