"""Several tasks at once, the first before the second: strict priorities.

A task is J v = b. The second moves the robot only as the first leaves free: it is done as well as
possible and disturbs nothing; the third only as both leave free, and so on.

Source: Siciliano and Slotine 1991; the order of two tasks in Nakamura, Hanafusa and Yoshikawa 1987.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers, short


def strict_priorities(
    tasks: Sequence[tuple[ArrayLike, ArrayLike]],
    preferred: ArrayLike | None = None,
    *,
    damping: ArrayLike = 0.0,
    least: float = 1e-8,
) -> NDArray:
    """Velocities that do each task as well as those before it allow.

    v = v1 + (J2 N1)^+ (b2 - J2 v1) + ..., where N1 takes from a velocity what the first task sees:
    of all v that do the first task as well as possible those that do the second as well as
    possible, and so on; what remains free is nearest to a preferred velocity.

    Args:
        tasks: (J, b), the most important first, shapes (..., m, n) and (..., m) in any units; m
            differs from task to task, and rows may depend on each other.
        preferred: v0 for what the tasks leave free, shape (..., n); zero if None.
        damping: lambda, one number for all tasks but the first, or one a task, in the units of J.
            Where J2 N1 has the singular value s, lambda^2 / (s^2 + lambda^2) of what is missing
            stays missing, and a velocity is at most the missing over 2 lambda. With 0 what is
            missing is done in full, with velocities that grow as 1 / s towards a singularity.
        least: share of the largest singular value of J, 0 to 1, below which one of J2 N1 counts as
            0: what is missing in its direction stays missing in full.

    Returns:
        v, shape (..., n).

    Raises:
        ValueError: no task, shapes that do not fit each other, values that are not finite,
            damping negative, or least not between 0 and 1.
    """
    tasks = _checked(tasks)
    *leading, _, n = tasks[0][0].shape
    damping, least = _damping(damping, len(tasks)), number(least, "least", above=0.0, below=1.0)
    v, free = np.zeros((*leading, n)), np.broadcast_to(np.eye(n), (*leading, n, n))
    for (J, b), damped in zip(tasks, damping, strict=True):
        largest = np.linalg.norm(J, 2, axis=(-2, -1))[..., None]
        left, sizes, along = np.linalg.svd(J @ free, full_matrices=False)
        kept = sizes > np.maximum(least * largest, 1e-300)
        sizes = np.where(kept, sizes, 1.0)
        gain = np.where(kept, sizes / (sizes**2 + damped**2), 0.0)
        missing = b - _times(J, v)
        moved = _times(
            np.swapaxes(along, -1, -2), gain * _times(np.swapaxes(left, -1, -2), missing)
        )
        v = v + _times(free, moved)
        along = along * kept[..., None]
        free = free - np.swapaxes(along, -1, -2) @ along
    if preferred is None:
        return v
    meaning = f"one value a column of J, {n}"
    return v + _times(free, numbers(preferred, "preferred", (*leading, n), meaning=meaning))


def _times(A: NDArray, x: NDArray) -> NDArray:
    return (A @ x[..., None])[..., 0]


def _damping(damping: ArrayLike, count: int) -> NDArray:
    given = numbers(damping, "damping")
    if given.shape not in ((), (count,)) or (given < 0).any():
        raise ValueError(f"damping must be 0 or more, once or for each task, got {short(damping)}")
    return given if given.ndim else np.r_[0.0, np.full(count - 1, given)]


def _checked(tasks: Sequence) -> list[tuple[NDArray, NDArray]]:
    if not isinstance(tasks, (list, tuple)) or not tasks:
        raise ValueError(f"tasks must be a list of one or more pairs (J, b), got {short(tasks)}")
    checked: list = []
    for k, task in enumerate(tasks):
        if not isinstance(task, (list, tuple)) or len(task) != 2:
            raise ValueError(f"tasks[{k}] must be a pair (J, b), got {short(task)}")
        shape = (..., "m", "n")
        if checked:
            *leading, _, n = checked[0][0].shape
            shape = (*leading, "m", n)
        J = numbers(task[0], f"J of tasks[{k}]", shape, meaning="a matrix", within=1e100)
        b = numbers(task[1], f"b of tasks[{k}]", J.shape[:-1], meaning="one value a row of its J")
        checked.append((J, b))
    return checked
