"""A sampled PID with a filtered derivative and an integral that cannot wind up.

In each sample k, with reference r, measurement y and e = r - y:

    U_k = P_k + I_k + D_k
    P_k = k_p e_k
    I_k = I_{k-1} + k_i T_s e_k
    D_k = a D_{k-1} - b (y_k - y_{k-1})

Sources: Mastalli 2013, eq. (3.28), without filter; D'Angelo 2022, eq. (4.6), with one. The integral
is the backward difference in both. The rule for the derivative k_d s / (T_f s + 1) is a choice:

| form | a | b | the filter is stable for |
|---|---|---|---|
| "backward" | T_f / (T_f + T_s) | k_d / (T_f + T_s) | every T_f, 0 included |
| "tustin" | (2 T_f - T_s) / (2 T_f + T_s) | 2 k_d / (2 T_f + T_s) | T_f > 0, rings below T_s/2 |
| "forward" | (T_f - T_s) / T_f | k_d / T_f | T_f > T_s/2 |

What (4.6) prints is "backward", though the text calls it Tustin's approximation.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, number, numbers, positive

_FORMS = ("backward", "tustin", "forward")
_ANTI_WINDUP = ("clamping", "none")
_DERIVATIVES = ("measurement", "error")


class DigitalPID:
    """A PID for one loop (floats) or for n loops at once (arrays), called once in each sample.

    Args:
        kp, ki, kd: gains of the parallel form, each a float or shape (n,) [output unit per unit
            measured, the same per s, the same times s]; floats and arrays of one length may mix.
        dt: sampling time T_s [s].
        derivative_filter: N, which gives the derivative's filter the time constant
            T_f = k_d / (k_p N); usually 3 to 20. None filters only if `filter_time` is given.
        filter_time: T_f itself, float or shape (n,) [s], instead of N.
        limits: (low, high) of the actuator, each a float or shape (n,), or None for no limits.
        anti_windup: "clamping" bounds the integral anew in each sample so that P + I + D stays
            within the limits, and never lets it go further out; "none" lets it wind up.
        form: rule for the derivative, "backward", "tustin" or "forward".
        derivative_of: "measurement", so that a jump of the reference gives no kick, or "error".

    Attributes:
        proportional, integral, derivative: the three terms of the last sample, before the limits.
        filter_time: T_f of each loop [s].

    Raises:
        ValueError: gains negative, not finite or of different lengths; dt, N or T_f not positive;
            limits not in order; an unknown word; a derivative that this form makes unstable.
    """

    def __init__(
        self,
        kp: ArrayLike,
        ki: ArrayLike,
        kd: ArrayLike,
        dt: float,
        *,
        derivative_filter: float | None = None,
        filter_time: ArrayLike | None = None,
        limits: tuple[ArrayLike, ArrayLike] | None = None,
        anti_windup: str = "clamping",
        form: str = "backward",
        derivative_of: str = "measurement",
    ) -> None:
        choice(anti_windup, "anti_windup", _ANTI_WINDUP)
        choice(form, "form", _FORMS)
        choice(derivative_of, "derivative_of", _DERIVATIVES)
        self.dt = positive(dt, "dt", "s")
        gains = [_row(gain, name) for name, gain in (("kp", kp), ("ki", ki), ("kd", kd))]
        low, high = (-np.inf, np.inf) if limits is None else _pair(limits)
        time = self._filter_time(gains, derivative_filter, filter_time)
        lengths = {len(value) for value in (*gains, low, high, time) if np.ndim(value)}
        if len(lengths) > 1:
            raise ValueError(
                "gains, limits and filter_time must be floats or of one length, got lengths "
                f"{sorted(lengths)}"
            )
        self.anti_windup, self.form, self.derivative_of = anti_windup, form, derivative_of
        self._shape = tuple(lengths)
        spread = (np.broadcast_to(value, self._shape) for value in (*gains, low, high, time))
        own = [value.astype(float) if self._shape else float(value) for value in spread]
        self.kp, self.ki, self.kd, self.low, self.high, self.filter_time = own
        if not np.all(self.low < self.high):
            raise ValueError(f"limits must be (low, high) with low below high, got {limits!r}")
        self._a, self._b = _derivative(self.kd, self.filter_time, self.dt, form)
        self.reset()

    @classmethod
    def from_ideal(
        cls, K: ArrayLike, Ti: ArrayLike, Td: ArrayLike, dt: float, **options: object
    ) -> DigitalPID:
        """The PID of eq. (3.28): K (e + 1/T_i sum e T_s + T_d (e_k - e_{k-1}) / T_s).

        Source: Mastalli 2013, eq. (3.28). Its derivative is of the error, without filter; that is
        what comes out with `derivative_of="error"`.

        Args:
            K: gain, float or shape (n,) [output unit per unit measured].
            Ti: integral time, the same shapes [s]; infinite for no integral.
            Td: derivative time, the same shapes [s].
            dt, options: as for the class.

        Raises:
            ValueError: Ti is not positive, or as for the class.
        """
        K, Td, Ti = numbers(K, "K"), numbers(Td, "Td"), numbers(Ti, "Ti", finite=False)
        if not (Ti > 0).all():
            raise ValueError(f"Ti must be positive (infinite for no integral), got {Ti}")
        return cls(K, K / Ti, K * Td, dt, **options)

    @classmethod
    def from_factored(
        cls, K: ArrayLike, Ki: ArrayLike, Kd: ArrayLike, dt: float, **options: object
    ) -> DigitalPID:
        """The PID as eq. (4.6) writes it, with K_p factored out of all three terms.

        Source: D'Angelo 2022, eq. (4.6).

        Args:
            K: his K_p, float or shape (n,) [output unit per unit measured].
            Ki: his K_i, the same shapes [1/s].
            Kd: his K_d, the same shapes [s].
            dt, options: as for the class; `derivative_filter` is his N.

        Raises:
            ValueError: as for the class.
        """
        K, Ki, Kd = numbers(K, "K"), numbers(Ki, "Ki"), numbers(Kd, "Kd")
        return cls(K, K * Ki, K * Kd, dt, **options)

    def reset(self) -> None:
        """Forget everything: the next sample is the first."""
        zero = np.zeros(self._shape) if self._shape else 0.0
        self.proportional = self.integral = self.derivative = zero
        self._last: float | NDArray | None = None

    def __call__(self, reference: ArrayLike, measured: ArrayLike) -> float | NDArray:
        """Output for one sample.

        Args:
            reference, measured: r and y, a float each for one loop, shape (n,) for n loops.

        Returns:
            U within the limits, a float for one loop, shape (n,) for n loops.

        Raises:
            ValueError: another shape, or a value that is not finite; the PID is as before then.
        """
        if self._shape:
            reference = numbers(reference, "reference", self._shape, meaning="one for each loop")
            measured = numbers(measured, "measured", self._shape, meaning="one for each loop")
        else:
            reference, measured = number(reference, "reference"), number(measured, "measured")
        least, most = (np.minimum, np.maximum) if self._shape else (min, max)
        error = reference - measured
        watched = -measured if self.derivative_of == "measurement" else error
        last = watched if self._last is None else self._last
        proportional = self.kp * error
        derivative = self._a * self.derivative + self._b * (watched - last)
        integral = self.integral + self.ki * self.dt * error
        if self.anti_windup == "clamping":
            old, rest = self.integral, proportional + derivative
            integral = least(integral, most(old, self.high - rest))
            integral = most(integral, least(old, self.low - rest))
        self.proportional, self.integral, self.derivative = proportional, integral, derivative
        self._last = watched
        return least(most(proportional + integral + derivative, self.low), self.high)

    def _filter_time(
        self, gains: list[NDArray], N: float | None, filter_time: ArrayLike | None
    ) -> NDArray:
        if N is not None and filter_time is not None:
            raise ValueError("give derivative_filter (N) or filter_time (T_f), not both")
        if filter_time is not None:
            return _row(filter_time, "filter_time")
        if N is None:
            return np.zeros(())
        N = positive(N, "derivative_filter")
        kp, _, kd = gains
        if np.any((kp == 0) & (kd > 0)):
            raise ValueError(
                "derivative_filter N means T_f = kd / (kp N) and needs kp above 0: "
                "give filter_time in s instead"
            )
        return kd / (np.where(kp > 0, kp, 1.0) * N)


def _derivative(kd: ArrayLike, T_f: ArrayLike, dt: float, form: str) -> tuple:
    """The a and b of D_k = a D_{k-1} - b (y_k - y_{k-1}), floats or shape (n,)."""
    weights = {
        "backward": (T_f, kd, T_f + dt),
        "tustin": (2 * T_f - dt, 2 * kd, 2 * T_f + dt),
        "forward": (T_f - dt, kd, T_f),
    }
    keeps, takes, total = (np.asarray(weight, dtype=float) for weight in weights[form])
    if np.any((kd > 0) & (np.abs(keeps) >= total)):
        shortest = {"tustin": "above 0", "forward": f"above dt / 2 = {dt / 2:g} s"}[form]
        raise ValueError(
            f'the derivative is unstable: form "{form}" needs a filter_time T_f {shortest}, got '
            f'{T_f} s: filter more, sample faster, or take form="backward"'
        )
    divisor = np.where(kd > 0, total, 1.0)
    a, b = (np.where(kd > 0, weight, 0.0) / divisor for weight in (keeps, takes))
    return (a, b) if np.ndim(kd) else (float(a), float(b))


def _row(value: ArrayLike, name: str, *, least: float = 0.0, finite: bool = True) -> NDArray:
    """One number, shape (), or one for each loop, shape (n,)."""
    row = numbers(value, name, finite=finite)
    if row.ndim > 1 or row.size == 0:
        raise ValueError(f"{name} must be one number or shape (n,), got shape {row.shape}")
    if (row < least).any():
        raise ValueError(f"{name} must not be negative, got {row}")
    return row


def _pair(limits: tuple[ArrayLike, ArrayLike]) -> list[NDArray]:
    if not (isinstance(limits, tuple | list) and len(limits) == 2):
        raise ValueError(f"limits must be (low, high) or None, got {limits!r}")
    return [_row(limit, "limits", least=-np.inf, finite=False) for limit in limits]
