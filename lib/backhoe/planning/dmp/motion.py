"""What was shown: positions at uneven times, and how fast and with which acceleration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics import inputs

LEAST = 5
"""Samples of a demonstration."""

SHORTEST, LARGEST = 1e-9, 1e9
"""Time between two samples [s]; positions and durations [unit, s]."""


@dataclass(frozen=True, eq=False)
class Motion:
    """One demonstration, its time from 0 on.

    Attributes:
        t: shape (m,) [s].
        x, v, a: positions, velocities, accelerations, shapes (m, d) [unit, unit/s, unit/s^2].
    """

    t: NDArray
    x: NDArray
    v: NDArray
    a: NDArray

    @property
    def duration(self) -> float:
        """From first to last sample [s]."""
        return float(self.t[-1])


def motion(positions: ArrayLike, times: ArrayLike, smoothing: float = 0.0) -> Motion:
    """A demonstration with its velocities and accelerations.

    Args:
        positions: shape (m, d), or (m,) for one dimension, m at least 5 [any unit].
        times: rising, shape (m,), or the step between samples, shape () [s].
        smoothing: half width of the window in which a parabola is fitted to the samples around each
            time; 0: three neighbours give the differences, noise and all [s].

    Raises:
        ValueError: too few samples, not finite, another shape, times that repeat or fall, or fewer
            than 5 samples in a window of the smoothing.
    """
    x = inputs.numbers(positions, "positions", within=LARGEST)
    x = inputs.numbers(x[:, None] if x.ndim == 1 else x, "positions", ("m", "d"))
    if len(x) < LEAST:
        raise ValueError(f"positions must have {LEAST} or more samples in a row, got {len(x)}")
    given = inputs.numbers(times, "times")
    if given.ndim == 0:
        t = inputs.number(times, "times", "s", above=0.0, most=LARGEST) * np.arange(len(x))
    else:
        t = inputs.times(given, "times")
        if len(t) != len(x):
            raise ValueError(f"times must be as many as positions, {len(x)}, got {len(t)}")
        t = t - t[0]
    if not np.diff(t).min() >= SHORTEST or t[-1] > LARGEST:
        raise ValueError(
            f"times must be {SHORTEST:g} s or more apart and last at most {LARGEST:g} s, got "
            f"{np.diff(t).min():.3g} s and {t[-1]:.3g} s"
        )
    half = inputs.not_negative(smoothing, "smoothing", "s")
    from backhoe.planning.dmp import engine

    x, v, a = np.array(x), np.empty(x.shape), np.empty(x.shape)
    if half == 0:
        engine.differences(t, x, v, a)
        return Motion(t, x, v, a)
    reached = np.searchsorted(t, t + half) - np.searchsorted(t, t - half, "right")
    if reached.min() < LEAST:
        at = t[reached.argmin()]
        raise ValueError(
            f"smoothing must reach {LEAST} samples around each time, {half:g} s reaches "
            f"{reached.min()} at {at:.4g} s: make it wider"
        )
    smooth = np.empty(x.shape)
    engine.parabolas(t, x, half, smooth, v, a)
    return Motion(t, smooth, v, a)
