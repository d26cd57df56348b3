"""The spring of a primitive, pulled along by a point that moves: exactly, or step by step.

A primitive is x'' = w^2 (u - x) - 2 z w x' with w^2 = K / tau^2 and 2 z w = D / tau: a damped
spring whose far end u is moved by the goal, the phase and the learnt force. Between two samples u
moves evenly; then each integrator below is one matrix for a step size, and so is the exact
solution.
"""

from __future__ import annotations

from math import inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics import inputs

INTEGRATORS = ("exact", "euler", "semi-implicit", "rk2", "rk4")
MOST_STEPS = 1_000_000
"""Of a roll-out."""

_TERMS = {"exact": 24, "euler": 1, "semi-implicit": 1, "rk2": 2, "rk4": 4}


def step_matrix(
    dt: float, stiffness: float, damping: float, tau: float, integrator: str = "exact"
) -> NDArray:
    """What a step does: (x, v) after it = M @ (x, v, u before, u after).

    Args:
        dt: the step [s].
        stiffness, damping, tau: K [1], D [1] and tau [s] of (6.4).
        integrator: "exact" (u moves evenly meanwhile), "euler", "semi-implicit", "rk2" or "rk4".

    Returns:
        M, shape (2, 4); v is dx/dt [1/s of the unit of x].

    Raises:
        ValueError: a number out of its bounds (damping may be 0), or another integrator.
    """
    dt = inputs.number(dt, "dt", "s", above=0.0, most=1e9)
    stiffness, damping, tau = checked(stiffness, damping, tau)
    inputs.choice(integrator, "integrator", INTEGRATORS)
    A = np.zeros((4, 4))  # of (x, v, u, du/dt)
    A[0, 1] = A[2, 3] = 1.0
    A[1, :3] = -stiffness / tau**2, -damping / tau, stiffness / tau**2
    halvings = int(max(0, np.ceil(np.log2(dt * np.abs(A).sum(axis=1).max() + 1e-300))))
    halvings = halvings if integrator == "exact" else 0
    M = term = np.eye(4)
    for k in range(1, _TERMS[integrator] + 1):
        term = term @ A * (dt / 2**halvings / k)
        M = M + term
    M = np.linalg.matrix_power(M, 2**halvings)
    if integrator == "semi-implicit":
        M[0] = [1, 0, 0, 0] + dt * M[1]
    to_slope = M[:2, 3:] / dt
    return np.hstack([M[:2, :2], M[:2, 2:3] - to_slope, to_slope])


def step_limit(stiffness: float, damping: float, tau: float, integrator: str) -> float:
    """The longest step for which a spring left alone comes to rest [s]; infinite if "exact".

    Args:
        stiffness, damping, tau, integrator: as for `step_matrix`.

    Raises:
        ValueError: as for `step_matrix`; a spring without damping, which never rests.
    """
    stiffness, damping, tau = checked(stiffness, damping, tau)
    inputs.number(damping, "damping", least=1e-6)
    if inputs.choice(integrator, "integrator", INTEGRATORS) == "exact":
        return inf

    def grows(dt: float) -> bool:
        M = step_matrix(dt, stiffness, damping, tau, integrator)
        return np.abs(np.linalg.eigvals(M[:, :2])).max() > 1.0

    low = 1e-3 * tau * min(damping / stiffness, stiffness**-0.5)
    high = 2 * low
    for _ in range(60):
        if grows(high):
            break
        low, high = high, 2 * high
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (low, middle) if grows(middle) else (middle, high)
    return low


def checked(stiffness: float, damping: float, tau: float) -> tuple[float, float, float]:
    """K [1], D [1] and tau [s] of a spring, within wide bounds; ValueError otherwise."""
    return (
        inputs.number(stiffness, "stiffness", least=1e-6, most=1e12),
        inputs.number(damping, "damping", least=0.0, most=1e12),
        inputs.number(tau, "tau", "s", least=1e-6, most=1e9),
    )


def whole_steps(duration: float, dt: float) -> int:
    """How many steps of at most dt fill the duration [s]; ValueError if more than a million."""
    if not duration / dt <= MOST_STEPS:
        raise ValueError(
            f"dt must be at least {duration / MOST_STEPS:.3g} s, a millionth of {duration:g} s, "
            f"got {dt:g} s"
        )
    return max(1, int(np.ceil(duration / dt - 1e-6)))


def refuse_unstable(dt: float, limit: float, integrator: str) -> None:
    """ValueError, with advice, for a step [s] beyond the limit [s]."""
    if dt > limit:
        raise ValueError(
            f"dt must be at most {limit:.4g} s for integrator {integrator!r} of this spring, got "
            f'{dt:.4g} s: the movement would swing ever wider; integrator "exact" has no limit'
        )


def follow(u: ArrayLike, x: ArrayLike, v: ArrayLike, M: NDArray) -> tuple[NDArray, NDArray]:
    """The spring's way when its far end takes the places u.

    Args:
        u: places in a row, shape (m, d) [any unit].
        x, v: where the spring is at first and how fast, shapes (d,) [that unit, that unit/s].
        M: of `step_matrix`, shape (2, 4).

    Returns:
        Positions and velocities, shapes (m, d).
    """
    u = inputs.numbers(u, "u", ("m", "d"))
    x = inputs.numbers(x, "x", u.shape[1:])
    v = inputs.numbers(v, "v", u.shape[1:])
    M = inputs.numbers(M, "M", (2, 4))
    from backhoe.planning.dmp import engine

    xs, vs = np.empty(u.shape), np.empty(u.shape)
    engine.follow(np.ascontiguousarray(u), x, v, M, xs, vs)
    return xs, vs
