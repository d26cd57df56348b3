"""Exercises 7.3 and 7.6: how a step carries errors on, and the noise that encoders put in."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE

_RADIUS, _GAUGE = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge


def step_jacobian(psi: float, v: float, omega: float, T_s: float) -> NDArray:
    """Derivative of (4.24) repaired, for x, y, psi, shape (3, 3): (4.25) repaired."""
    middle = psi + omega * T_s / 2
    F = np.eye(3)
    F[0, 2] = -v * T_s * np.sin(middle)
    F[1, 2] = v * T_s * np.cos(middle)
    return F


def _steps(rng: np.random.Generator) -> list[tuple]:
    low, high = (-3.0, 0.3, 0.3, 0.02), (3.0, 1.5, 0.9, 0.5)
    return [tuple(rng.uniform(low, high)) for _ in range(40)]


def _jacobian(column: NDArray, identity: float = 1.0) -> NDArray:
    F = identity * np.eye(3)
    F[:2, 2] = column
    return F


def _column(psi: float, v: float, omega: float, T_s: float, share: float = 0.5) -> NDArray:
    middle = psi + share * omega * T_s
    return v * T_s * np.array([-np.sin(middle), np.cos(middle)])


JACOBIAN = Exercise(
    number="7.3",
    title="Repair (4.25)",
    reference=step_jacobian,
    cases=_steps,
    mistakes={
        "T_s is missing, as in (4.25): v is metres a second, the step is v T_s metres": (
            lambda psi, v, omega, T_s: _jacobian(_column(psi, v, omega, T_s) / T_s)
        ),
        "sine and cosine are swapped: the derivative of the cosine is minus the sine": (
            lambda psi, v, omega, T_s: _jacobian(_column(psi, v, omega, T_s)[::-1] * (-1, -1))
        ),
        "that is the step itself, cosine and sine: differentiate it by psi": (
            lambda psi, v, omega, T_s: _jacobian(_column(psi, v, omega, T_s)[::-1] * (1, -1))
        ),
        "the minus of the first row is missing: d cos/d psi = -sin": (
            lambda psi, v, omega, T_s: _jacobian(_column(psi, v, omega, T_s) * (-1, 1))
        ),
        "both signs are turned round: minus the sine in x, plus the cosine in y": (
            lambda psi, v, omega, T_s: _jacobian(-_column(psi, v, omega, T_s))
        ),
        "the heading is that of the start: (4.25) rightly has that of the middle": (
            lambda psi, v, omega, T_s: _jacobian(_column(psi, v, omega, T_s, 0.0))
        ),
        "the heading is that of the end, as in (4.24): take half of the turn": (
            lambda psi, v, omega, T_s: _jacobian(_column(psi, v, omega, T_s, 1.0))
        ),
        "that is df/dx of the rate (4.20): a discrete F has an identity and T_s": (
            lambda psi, v, omega, T_s: _jacobian(_column(psi, v, omega, T_s, 0.0) / T_s, 0.0)
        ),
        "the identity is missing: an error of x before the step is one after it": (
            lambda psi, v, omega, T_s: _jacobian(_column(psi, v, omega, T_s), 0.0)
        ),
        "it is transposed: row x, column psi says what an error of psi does to x": (
            lambda psi, v, omega, T_s: step_jacobian(psi, v, omega, T_s).T
        ),
        "psi and omega are in radians already": (
            lambda psi, v, omega, T_s: step_jacobian(np.radians(psi), v, np.radians(omega), T_s)
        ),
    },
    hints=(
        "x_k = x + v T_s cos(psi + omega T_s/2): differentiate by x, by y, by psi.",
        "Ones on the diagonal; in the last column -v T_s sin and v T_s cos of the middle heading.",
    ),
    tested_on="40 random steps to the left",
)


def encoder_noise(psi: float, left: float, right: float, variance: float) -> NDArray:
    """Covariance that the encoders' noise puts into x, y, psi in a step, shape (3, 3)."""
    s, d = _RADIUS * (left + right) / 2, _RADIUS * (right - left) / _GAUGE
    cos, sin = np.cos(psi + d / 2), np.sin(psi + d / 2)
    of_s_and_d = np.array([[cos, -s * sin / 2], [sin, s * cos / 2], [0, 1]])
    of_sides = _RADIUS * np.array([[1 / 2, 1 / 2], [-1 / _GAUGE, 1 / _GAUGE]])
    G = of_s_and_d @ of_sides
    return variance * G @ G.T


def _noises(rng: np.random.Generator) -> list[tuple]:
    low, high = (-3.0, 0.3, 0.3, 0.01), (3.0, 1.5, 1.5, 0.3)
    return [tuple(rng.uniform(low, high)) for _ in range(30)]


def _noise(
    psi: float,
    left: float,
    right: float,
    variance: float,
    gauge: float = _GAUGE,
    half: float = 0.5,
    lever: float | None = None,
    sides: NDArray | None = None,
) -> NDArray:
    s, d = _RADIUS * (left + right) / 2, _RADIUS * (right - left) / _GAUGE
    cos, sin = np.cos(psi + half * d), np.sin(psi + half * d)
    arm = s * (half if lever is None else lever)
    of_s_and_d = np.array([[cos, -arm * sin], [sin, arm * cos], [0, 1]])
    G = of_s_and_d @ (_RADIUS * np.array([[1 / 2, 1 / 2], [-1 / gauge, 1 / gauge]]))
    M = variance * (np.eye(2) if sides is None else sides)
    return G @ M @ G.T


NOISE = Exercise(
    number="7.6",
    title="Noise of the encoders in the pose",
    reference=encoder_noise,
    cases=_noises,
    mistakes={
        "that puts a standard deviation where a variance belongs": (
            lambda psi, left, right, variance: _noise(psi, left, right, np.sqrt(variance))
        ),
        "the variance is squared: G takes it as it is, G M G^T": (
            lambda psi, left, right, variance: _noise(psi, left, right, variance**2)
        ),
        "the noise is in radians of the sprocket: r makes metres of it, r^2 square metres": (
            lambda psi, left, right, variance: _noise(psi, left, right, variance / _RADIUS**2)
        ),
        "both sides err alike and the heading never: the encoders' noises are independent": (
            lambda psi, left, right, variance: _noise(
                psi, left, right, variance, sides=np.ones((2, 2))
            )
        ),
        "the heading's noise is twice too large: the turn is r (right - left)/l, l the gauge": (
            lambda psi, left, right, variance: _noise(psi, left, right, variance, _GAUGE / 2)
        ),
        "half of the turn is missing: an error of d also turns the way, by d/2": (
            lambda psi, left, right, variance: _noise(psi, left, right, variance, half=0.0)
        ),
        "x and y change with the turn, too: differentiate the d/2 in their cosine and sine": (
            lambda psi, left, right, variance: _noise(psi, left, right, variance, lever=0.0)
        ),
        "only the variances are kept: an error of one sprocket moves x, y and psi together": (
            lambda psi, left, right, variance: np.diag(np.diag(_noise(psi, left, right, variance)))
        ),
        "that is the encoders' variance on x, y and psi: carry it there with G": (
            lambda psi, left, right, variance: variance * np.eye(3)
        ),
    },
    hints=(
        "s = r (left + right)/2, d = r (right - left)/l; x, y, psi change with s and d.",
        "G is d(x, y, psi)/d(left, right), shape (3, 2), by the chain rule; Q = variance G G^T.",
    ),
    tested_on="30 random steps of the backhoe",
)
