"""Formulas and steps of Mastalli 2013, sections 5.3 and 5.4, as printed. Not for use.

The appendix of chapter 9 tests them; `backhoe.perception` has what they should be. Numbers as
printed are in `data/published/mastalli_2013_section_53.toml`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, number, numbers

__all__ = ["above_the_plane", "looks_52", "posterior_51"]


def posterior_51(look: ArrayLike, before: ArrayLike, prior: ArrayLike) -> NDArray:
    """(5.1): probability that a node is occupied, after one more look.

    Its last factor is upside down: (1 - P(n)) / P(n) stands for P(n) / (1 - P(n)), so that the
    prior is counted twice instead of taken out once. On its left the bar of "given" is a comma.

    Args:
        look: P(n | z_k), what the new look says by itself, shape (...), between 0 and 1 [1].
        before: P(n | z_1:k-1), shape (...), between 0 and 1 [1].
        prior: P(n), shape (...), between 0 and 1 [1].

    Returns:
        Shape (...) [1].

    Raises:
        ValueError: not finite numbers.
    """
    z, p, n = (
        numbers(value, name)
        for name, value in (("look", look), ("before", before), ("prior", prior))
    )
    return 1 / (1 + (1 - z) / z * (1 - p) / p * (1 - n) / n)


def looks_52(looks: float) -> float:
    """The text below (5.2): a change of state asks for as many looks as made the state.

    Args:
        looks: that found a voxel occupied, 0 or more [1].

    Returns:
        Looks until it is free [1].

    Raises:
        ValueError: not a number of 0 or more.
    """
    return not_negative(looks, "looks")


def above_the_plane(points: ArrayLike, height: float = 0.1) -> NDArray:
    """Which points are left in section 5.4.3, where those of the ground's plane are discarded.

    How the plane is found, and how thick it is, is not printed: here it is z = 0.

    Args:
        points: in the world, shape (n, 3) [m].
        height: how far from the plane a point still counts as ground, our choice [m].

    Returns:
        True for a point that is kept, shape (n,).

    Raises:
        ValueError: other shapes, or values that are not finite.
    """
    height = number(height, "height", "m", above=0.0)
    return np.abs(numbers(points, "points", ("n", 3))[:, 2]) > height
