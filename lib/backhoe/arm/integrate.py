"""Fixed-step integrators, each a few lines, for comparing what they do to a motion.

All go from x0 and return each state on the way. Most step dx/dt = f(t, x), with `f` as scipy's
`solve_ivp` takes it; `motion` makes such an f of an acceleration, with the state x = (q, dq).

| rule | order | energy of an arm that swings freely for 300 s, in steps of 20 ms |
|---|---|---|
| `euler` | 1 | grows from the start |
| `semi_implicit_euler` | 1 | wanders off, and is infinite before the end |
| `symplectic_euler` | 1 | within a band, as it is symplectic whatever M(q) does |
| `trapezoid` | 2 | wanders by a tenth of that band |
| `rk4` | 4 | falls, by a hundredth of that band |

Source of the symplectic step: E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration,
Springer 2006, section VI.3.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive, whole

__all__ = [
    "Rollout",
    "euler",
    "motion",
    "rk4",
    "semi_implicit_euler",
    "symplectic_euler",
    "trapezoid",
]

Rate = Callable[[float, NDArray], ArrayLike]
Acceleration = Callable[[float, NDArray, NDArray], ArrayLike]
Terms = Callable[[NDArray], tuple[ArrayLike, ArrayLike, ArrayLike]]


class Rollout(NamedTuple):
    """Times (steps + 1,) [s] and states (steps + 1, n), the first row the start."""

    t: NDArray
    x: NDArray


def motion(acceleration: Acceleration) -> Rate:
    """The rate f(t, x) of a state x = (q, dq) whose acceleration is known.

    Args:
        acceleration: function of t, q and dq that gives ddq; all of one shape (n,).

    Returns:
        f with f(t, (q, dq)) = (dq, ddq), shape (2 n,).
    """

    def f(t: float, x: NDArray) -> NDArray:
        q, dq = np.split(x, 2)
        return np.concatenate([dq, acceleration(t, q, dq)])

    return f


def euler(f: Rate, x0: ArrayLike, dt: float, steps: int) -> Rollout:
    """Explicit Euler: x_k+1 = x_k + dt f(t_k, x_k).

    Args:
        f: rate of the state, f(t, x) of the shape of x.
        x0: state at time 0, shape (n,).
        dt: step [s].
        steps: number of steps.

    Returns:
        Times and states.

    Raises:
        ValueError: x0 is not one row of finite numbers, dt is not positive, steps is not a count,
            or f gives another shape.
        FloatingPointError: the state is no longer finite: the step is too long.
    """

    def step(t: float, x: NDArray) -> NDArray:
        return x + dt * np.asarray(f(t, x))

    return _roll_out(step, f, x0, dt, steps)


def semi_implicit_euler(
    acceleration: Acceleration, x0: ArrayLike, dt: float, steps: int
) -> Rollout:
    """Semi-implicit Euler: first the speed, then the position with the new speed.

    dq_k+1 = dq_k + dt a(t_k, q_k, dq_k), q_k+1 = q_k + dt dq_k+1: what PyBullet does, and MuJoCo
    unless told otherwise. It is symplectic where a does not depend on dq; an arm's does, and then
    nothing holds its energy. It takes the acceleration itself, not its `motion`.

    Args:
        acceleration: function of t, q and dq that gives ddq.
        x0: state (q, dq) at time 0, shape (2 n,).
        dt, steps: as for `euler`.

    Returns:
        Times and states (q, dq).

    Raises:
        ValueError: as for `euler`, or x0 does not split in two halves.
        FloatingPointError: as for `euler`.
    """
    _halves(x0)

    def step(t: float, x: NDArray) -> NDArray:
        q, dq = np.split(x, 2)
        dq = dq + dt * np.asarray(acceleration(t, q, dq))
        return np.concatenate([q + dt * dq, dq])

    return _roll_out(step, motion(acceleration), x0, dt, steps)


def symplectic_euler(
    terms: Terms,
    x0: ArrayLike,
    dt: float,
    steps: int,
    tolerance: float = 1e-12,
    max_iterations: int = 50,
) -> Rollout:
    """Symplectic Euler: first the momentum p = M(q) dq, then the position with the new momentum.

    p_k+1 = p_k + dt (v dM/dq v / 2 - g(q_k)) with v = M(q_k)^-1 p_k+1, and q_k+1 = q_k + dt v. The
    first is an equation for v, repeated until it stands still. For a constant M this is
    `semi_implicit_euler`.

    Args:
        terms: function of q, shape (n,), that gives the mass matrix M (n, n), its derivatives
            dM (n, n, n), dM[k] by q_k, and the slope g (n,) of the potential energy, from which
            constant forces are taken off.
        x0, dt, steps: as for `semi_implicit_euler`.
        tolerance, max_iterations: as for `trapezoid`.

    Returns:
        Times and states (q, dq).

    Raises:
        ValueError: as for `semi_implicit_euler`.
        ArithmeticError: the repetition does not stand still: the step is too long.
        FloatingPointError: as for `euler`.
    """
    _halves(x0)
    here = None

    def step(t: float, x: NDArray) -> NDArray:
        nonlocal here
        q, dq = np.split(x, 2)
        M, dM, g = here or terms(q)
        momentum, inverse = M @ dq - dt * np.asarray(g), np.linalg.inv(M)

        def again(v: NDArray) -> NDArray:
            return inverse @ (momentum + dt / 2 * (dM @ v @ v))

        v = _settled(again, dq, tolerance, max_iterations, "symplectic Euler rule", t, dt)
        q = q + dt * v
        here = terms(q)
        return np.concatenate([q, np.linalg.solve(here[0], M @ v)])

    return _roll_out(step, motion(lambda t, q, dq: terms(q)[2]), x0, dt, steps)


def trapezoid(
    f: Rate,
    x0: ArrayLike,
    dt: float,
    steps: int,
    tolerance: float = 1e-12,
    max_iterations: int = 50,
) -> Rollout:
    """Trapezoidal rule: x_k+1 = x_k + dt/2 (f(t_k, x_k) + f(t_k+1, x_k+1)), solved for x_k+1.

    Implicit; the equation is repeated from a predicted x_k+1 until it stands still, which it does
    for steps below 2 over the fastest rate of the system: stiff systems gain nothing here.

    Source: Mastalli 2013, section 2.3.1, "integración trapezoidal".

    Args:
        f, x0, dt, steps: as for `euler`.
        tolerance: largest change in the last repetition, relative to 1 plus the component.
        max_iterations: repetitions before giving up.

    Returns:
        Times and states.

    Raises:
        ValueError: as for `euler`.
        ArithmeticError: the repetition does not stand still: the step is too long.
        FloatingPointError: as for `euler`.
    """

    def step(t: float, x: NDArray) -> NDArray:
        rate = np.asarray(f(t, x))

        def again(new: NDArray) -> NDArray:
            return x + dt / 2 * (rate + np.asarray(f(t + dt, new)))

        guess = x + dt * rate
        return _settled(again, guess, tolerance, max_iterations, "trapezoidal rule", t, dt)

    return _roll_out(step, f, x0, dt, steps)


def rk4(f: Rate, x0: ArrayLike, dt: float, steps: int) -> Rollout:
    """The classical Runge-Kutta rule of fourth order; arguments and errors as for `euler`."""

    def step(t: float, x: NDArray) -> NDArray:
        k1 = np.asarray(f(t, x))
        k2 = np.asarray(f(t + dt / 2, x + dt / 2 * k1))
        k3 = np.asarray(f(t + dt / 2, x + dt / 2 * k2))
        k4 = np.asarray(f(t + dt, x + dt * k3))
        return x + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)

    return _roll_out(step, f, x0, dt, steps)


def _halves(x0: ArrayLike) -> None:
    if np.size(x0) % 2:
        raise ValueError(f"x0 must be positions and as many speeds, got {np.size(x0)} values")


def _settled(
    again: Callable, x: NDArray, tolerance: float, most: int, rule: str, t: float, dt: float
) -> NDArray:
    """Repeat x = again(x) until it stands still."""
    for _ in range(most):
        old, x = x, again(x)
        if (np.abs(x - old) <= tolerance * (1 + np.abs(x))).all():
            return x
    raise ArithmeticError(
        f"the {rule} did not settle in {most} repetitions at t = {t:.4g} s:"
        f" take a step shorter than {dt:.4g} s"
    )


def _roll_out(step: Callable, f: Rate, x0: ArrayLike, dt: float, steps: int) -> Rollout:
    """Check the arguments, then repeat a step."""
    x = numbers(x0, "x0", ("n",), meaning="one row of numbers")
    whole(steps, "steps", least=0)
    positive(dt, "dt", "s")
    rate = np.shape(f(0.0, x))
    if rate != x.shape:
        raise ValueError(f"the rate must have the shape of the state, {x.shape}, got {rate}")
    t = dt * np.arange(steps + 1)
    states = np.empty((steps + 1, x.size))
    states[0] = x
    for k in range(steps):
        with np.errstate(over="ignore", invalid="ignore"):
            states[k + 1] = x = step(t[k], x)
        if not np.isfinite(x).all():
            raise FloatingPointError(
                f"the state is no longer finite at t = {t[k + 1]:.4g} s: take a step shorter than"
                f" {dt:.4g} s"
            )
    return Rollout(t, states)
