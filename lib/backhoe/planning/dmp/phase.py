"""The clock of a primitive: a phase that falls from 1 and, so that time can be stretched, never
knows the seconds.

Source: Mastalli 2013, (6.7) and (6.10).
"""

from __future__ import annotations

from math import exp, log

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers

END_PHASE = exp(-5.25)
"""Phase at the end of a movement, 0.0052: (6.10)."""


def phase_rate(duration: float, tau: float = 1.0, end_phase: float = END_PHASE) -> float:
    """alpha of tau ds/dt = -alpha s, for a phase that is `end_phase` after `duration`: (6.10).

    Args:
        duration: of the movement [s].
        tau: factor of time, of the transformation system too [s].
        end_phase: above 0 and below 1.

    Raises:
        ValueError: an argument that is not a number within its bounds.
    """
    duration = number(duration, "duration", "s", least=1e-9, most=1e9)
    tau = number(tau, "tau", "s", least=1e-6, most=1e9)
    return -log(number(end_phase, "end_phase", above=0.0, below=1.0)) * tau / duration


def phase(t: ArrayLike, duration: float, end_phase: float = END_PHASE) -> NDArray:
    """s(t), which is 1 at t = 0 and `end_phase` at `duration`: the solution of (6.7).

    Args:
        t: times, any shape [s].
        duration: of the movement [s].
        end_phase: above 0 and below 1.

    Returns:
        Phases of the shape of t [1].

    Raises:
        ValueError: times that are not finite, or as for `phase_rate`.
    """
    return np.exp(-phase_rate(duration, 1.0, end_phase) * numbers(t, "t"))


def minimum_jerk(u: ArrayLike) -> tuple[NDArray, NDArray, NDArray]:
    """From 0 to 1 and at rest at both ends: value, slope and curvature at u in 0..1, its shape [1].

    Raises:
        ValueError: not numbers from 0 to 1.
    """
    u = numbers(u, "u", within=1.0 + 1e-9)
    return (
        u**3 * (10 - 15 * u + 6 * u**2),
        30 * u**2 * (1 - u) ** 2,
        60 * u * (1 - u) * (1 - 2 * u),
    )
