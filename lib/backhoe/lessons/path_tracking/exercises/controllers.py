"""Exercise 5.6: Scaglia's controller repaired, so that it is the least of its cost."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.lessons.exercise import Exercise


def scaglia(pose: ArrayLike, goal: ArrayLike, dt: float, kv2: float, kw2: float) -> NDArray:
    """V [m/s] and W [rad/s] at the least cost J_n (6.12), k_v^2 and k_w^2 of (6.14)."""
    x, y, theta = pose
    dx, dy = goal[0] - x, goal[1] - y
    theta_d = np.arctan2(dy, dx)
    turn = (theta_d - theta + np.pi) % (2 * np.pi) - np.pi
    V = kv2 * (dx * np.cos(theta) + dy * np.sin(theta)) / dt
    return np.array([V, kw2 * turn / dt])


def _cases(rng: np.random.Generator) -> list[tuple]:
    return [
        (pose, pose[:2] + step, *parameters)
        for pose, step, parameters in zip(
            rng.uniform((-3, -3, -7), (3, 3, 7), (60, 3)),
            rng.uniform(-0.5, 0.5, (60, 2)),
            rng.uniform((0.02, 0.2, 0.2), (0.2, 0.95, 0.95), (60, 3)).tolist(),
            strict=True,
        )
    ]


def _variant(speed: object = None, turn: object = None) -> object:
    """The reference with V or W worked out anew from dx, dy, theta, theta_d, dt, kv2 and kw2."""

    def wrong(pose: NDArray, goal: NDArray, dt: float, kv2: float, kw2: float) -> NDArray:
        right = scaglia(pose, goal, dt, kv2, kw2)
        dx, dy, theta = *(goal - pose[:2]), pose[2]
        given = dx, dy, theta, np.arctan2(dy, dx), dt, kv2, kw2
        V = speed(*given) if speed else right[0]
        return np.array([V, turn(*given) if turn else right[1]])

    return wrong


def _wrap(angle: float) -> float:
    return (angle + np.pi) % (2 * np.pi) - np.pi


def _along(dx: float, dy: float, angle: float) -> float:
    return dx * np.cos(angle) + dy * np.sin(angle)


def _printed_913(
    dx: float, dy: float, theta: float, theta_d: float, dt: float, kv2: float, kw2: float
) -> float:
    """V from (9.13) as printed, whose derivative has lost a minus: k1 = 1, k2 from k_v^2."""
    k2_squared = dt**2 * (1 / kv2 - 1)
    return _along(dx, dy, theta) * dt / (dt**2 - k2_squared)


SCAGLIA = Exercise(
    number="5.6",
    title="Repair (6.13)",
    reference=scaglia,
    cases=_cases,
    mistakes={
        (
            "V is (6.13a) as printed, the whole distance over dt: the least of J has theta_n, not "
            "theta_d"
        ): _variant(lambda dx, dy, th, thd, dt, kv2, kw2: kv2 * _along(dx, dy, thd) / dt),
        "that solves (9.13) as printed: the derivative of the square has lost its minus": (
            _variant(_printed_913)
        ),
        "theta_d - theta is not wrapped: after a full turn the vehicle unwinds it again": (
            _variant(turn=lambda dx, dy, th, thd, dt, kv2, kw2: kw2 * (thd - th) / dt)
        ),
        "V is (6.13a) as printed, and theta_d - theta is not wrapped": (
            _variant(
                lambda dx, dy, th, thd, dt, kv2, kw2: kv2 * _along(dx, dy, thd) / dt,
                lambda dx, dy, th, thd, dt, kv2, kw2: kw2 * (thd - th) / dt,
            )
        ),
        "np.arctan cannot tell ahead from behind: use np.arctan2 for theta_d": (
            _variant(
                turn=lambda dx, dy, th, thd, dt, kv2, kw2: kw2 * _wrap(np.arctan(dy / dx) - th) / dt
            )
        ),
        "T_0 is missing: these are a distance and an angle, divide both by dt": (
            lambda pose, goal, dt, kv2, kw2: scaglia(pose, goal, 1.0, kv2, kw2)
        ),
        "T_0 is missing in W: an angle over dt is a rate": (
            _variant(turn=lambda dx, dy, th, thd, dt, kv2, kw2: kw2 * _wrap(thd - th))
        ),
        "W turns away from the goal: theta_d - theta, not the other way round": (
            _variant(turn=lambda dx, dy, th, thd, dt, kv2, kw2: kw2 * _wrap(th - thd) / dt)
        ),
        "kv2 and kw2 are k_v^2 and k_w^2 already: do not square them again": (
            lambda pose, goal, dt, kv2, kw2: scaglia(pose, goal, dt, kv2**2, kw2**2)
        ),
        "the weights are swapped: kv2 belongs to V, kw2 to W": (
            lambda pose, goal, dt, kv2, kw2: scaglia(pose, goal, dt, kw2, kv2)
        ),
        "that is (9.11) with theta, the dead beat: the weights kv2 and kw2 are left out": (
            lambda pose, goal, dt, kv2, kw2: scaglia(pose, goal, dt, 1.0, 1.0)
        ),
        "W is in degrees per second: everything inside the course is in radians": (
            lambda pose, goal, dt, kv2, kw2: scaglia(pose, goal, dt, kv2, kw2) * (1, 180 / np.pi)
        ),
    },
    hints=(
        "J has V only in x_{n+1} = x_n + V cos(theta_n) T_0 and its fellows: set dJ/dV to zero.",
        "V = kv2 (dx cos(theta) + dy sin(theta))/dt; W = kw2 times the wrapped theta_d - theta, "
        "over dt.",
    ),
    tested_on="60 random poses and goals",
)
