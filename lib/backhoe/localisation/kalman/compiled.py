"""The compiled modules, imported when a filter first needs them: Numba takes half a second."""

from __future__ import annotations

from functools import cache
from types import ModuleType


@cache
def kernels() -> ModuleType:
    """`backhoe.localisation.kalman.kernels`, for one filter."""
    from backhoe.localisation.kalman import kernels

    return kernels


@cache
def lanes() -> ModuleType:
    """`backhoe.localisation.kalman.lane_kernels`, for a batch."""
    from backhoe.localisation.kalman import lane_kernels

    return lane_kernels
