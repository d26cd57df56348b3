"""Checks of what the estimators are given."""

from __future__ import annotations

from math import isfinite
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array
from backhoe.localisation.drives import Recording


def not_negative(name: str, value: float) -> float:
    """The value as a float, if it is a finite number of 0 or more."""
    number = isinstance(value, Real) and not isinstance(value, bool)
    if not number or not isfinite(value) or value < 0:
        raise ValueError(f"{name} must be a finite number, 0 or more, got {value!r}")
    return float(value)


def start_pose(recording: Recording, start: ArrayLike | None) -> NDArray:
    """Where a run begins, shape (runs, 3) or (1, 3): as told, else the truth."""
    if not isinstance(recording, Recording):
        raise TypeError(
            f"recording must be a drives.Recording, got {recording!r}: drives.load(...) or "
            "drives.record(...) gives one"
        )
    runs = len(np.atleast_2d(recording.left))
    pose = recording.truth[0] if start is None else start
    pose = real_array(pose, "start must be x, y, heading [m, m, rad]")
    if pose.shape not in ((3,), (runs, 3)) or not np.isfinite(pose).all():
        raise ValueError(f"start must be a finite pose (3,) or ({runs}, 3), got {pose.shape}")
    return np.array(np.broadcast_to(pose, (runs, 3)))


def deviations(name: str, std: ArrayLike, count: int) -> NDArray:
    """Standard deviations, shape (count,), positive."""
    std = real_array(std, f"{name} must be {count} standard deviations")
    if std.shape != (count,) or not (np.isfinite(std).all() and (std > 0).all()):
        raise ValueError(f"{name} must be {count} positive standard deviations, got {std}")
    return std
