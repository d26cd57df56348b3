"""Estimators as they run on a controller: a state and a sample in, the next state out.

A state holds the last sample with its time, so the first sample only starts the estimator and no
step looks at a speed that nobody measured. f(x, u) gives the rate of x; `robots` and `linear` make
such an f.

| step | what it is | order |
|---|---|---|
| `euler` | the new sample at the old x: PUCP (7), and what Algorithm 3 comes to | 1 |
| `implicit_euler` | PUCP (10) solved for x_k | 1 |
| `heun` | PUCP (11) with x_k predicted by Euler; with a constant J it is (8) | 2 |
| `bilinear` | PUCP (11) solved for x_k | 2 |

Source: PUCP guide 2024, eqs. (7) to (11) and Algorithms 1 to 4; as printed they are in
`backhoe.lessons.odometry.printed`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, times

Rate = Callable[[NDArray, NDArray], ArrayLike]

TOLERANCE = 1e-12
"""Largest change of the last repetition, relative to 1 plus the component."""

REPETITIONS = 50


class State(NamedTuple):
    """What an estimator remembers: time [s], estimate x (n,) and the sample u (m,) of that time."""

    t: float
    x: NDArray
    u: NDArray


def euler(state: State, t: float, u: ArrayLike, f: Rate) -> State:
    """x_k = x_{k-1} + delta f(x_{k-1}, u_k).

    Args:
        state: the last state.
        t: time of the new sample [s].
        u: the sample, shape (m,), of any unit.
        f: rate of x.

    Returns:
        The next state.

    Raises:
        ValueError: t is not after the state's, u has another shape or is not finite.
    """
    dt, u = _sample(state, t, u)
    return State(t, state.x + dt * np.asarray(f(state.x, u)), u)


def implicit_euler(state: State, t: float, u: ArrayLike, f: Rate) -> State:
    """x_k = x_{k-1} + delta f(x_k, u_k), repeated from Euler's x_k until it stands still.

    Source: PUCP (10). Arguments, returns and errors as for `euler`; ArithmeticError when the
    repetition does not settle, because delta is longer than 1 over the fastest rate of f.
    """
    dt, u = _sample(state, t, u)
    return State(t, _settled(lambda x: state.x + dt * np.asarray(f(x, u)), state.x, t), u)


def heun(state: State, t: float, u: ArrayLike, f: Rate) -> State:
    """x_k = x_{k-1} + delta/2 (f(x_p, u_k) + f(x_{k-1}, u_{k-1})), x_p predicted by Euler's rule.

    Source: PUCP (11) with a predictor. Arguments, returns and errors as for `euler`.
    """
    dt, u = _sample(state, t, u)
    rate = np.asarray(f(state.x, state.u))
    predicted = state.x + dt * rate
    return State(t, state.x + dt / 2 * (np.asarray(f(predicted, u)) + rate), u)


def bilinear(state: State, t: float, u: ArrayLike, f: Rate) -> State:
    """x_k = x_{k-1} + delta/2 (f(x_k, u_k) + f(x_{k-1}, u_{k-1})), repeated until it stands still.

    Source: PUCP (11). Arguments, returns and errors as for `implicit_euler`.
    """
    dt, u = _sample(state, t, u)
    half = state.x + dt / 2 * np.asarray(f(state.x, state.u))
    return State(t, _settled(lambda x: half + dt / 2 * np.asarray(f(x, u)), state.x, t), u)


def linear(J: ArrayLike) -> Rate:
    """The rate f(x, u) = J u of a constant Jacobian, as in PUCP (7) and (8).

    Args:
        J: shape (n, m) [unit of x over unit of u and s].

    Returns:
        f.

    Raises:
        ValueError: J is not a matrix of finite numbers.
    """
    J = numbers(J, "J", ("n", "m"))
    return lambda x, u: J @ u


def run(
    step: Callable[[State, float, NDArray, Rate], State],
    f: Rate,
    t: ArrayLike,
    u: ArrayLike,
    x0: ArrayLike,
) -> NDArray:
    """Estimates at all instants, one step after the other.

    Args:
        step: `euler`, `heun` or another of their kind, yours too.
        f: rate of x, f(x (n,), u (m,)) -> (n,).
        t: instants, rising, shape (N+1,) [s].
        u: samples at them, shape (N+1, m), of any unit.
        x0: estimate at t[0], shape (n,), of any unit.

    Returns:
        Shape (N+1, n), the first row x0.

    Raises:
        ValueError: shapes that do not fit, a value that is not finite, t that does not rise, a
            rate of another shape than x.
    """
    t, x0 = times(t), numbers(x0, "x0", ("n",))
    u = numbers(u, "u", (len(t), "m"), meaning="a sample for each time")
    if np.shape(f(x0, u[0])) != x0.shape:
        raise ValueError(f"f must give {x0.shape}, as x0, got shape {np.shape(f(x0, u[0]))}")
    state = State(float(t[0]), x0, u[0])
    estimates = [x0]
    for time, sample in zip(t[1:].tolist(), u[1:], strict=True):
        state = step(state, time, sample, f)
        estimates.append(state.x)
    return np.array(estimates)


def _sample(state: State, t: float, u: ArrayLike) -> tuple[float, NDArray]:
    u = numbers(u, "u")
    if u.shape != np.shape(state.u):
        raise ValueError(f"u must be as the sample before, {np.shape(state.u)}, got {u.shape}")
    if not t > state.t:
        raise ValueError(f"a sample at {t} s cannot follow one at {state.t} s: times must rise")
    return t - state.t, u


def _settled(repeat: Callable[[NDArray], NDArray], x: NDArray, t: float) -> NDArray:
    for _ in range(REPETITIONS):
        old, x = x, repeat(x)
        if (np.abs(x - old) <= TOLERANCE * (1 + np.abs(x))).all():
            return x
    raise ArithmeticError(
        f"x_k did not settle in {REPETITIONS} repetitions at t = {t:.4g} s: sample faster, or "
        "predict x_k with `heun`"
    )
