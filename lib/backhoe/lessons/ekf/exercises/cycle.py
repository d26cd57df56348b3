"""Exercise 7.7: a whole cycle, the pose moved by the encoders and corrected by a yaw."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.ekf.exercises.motion import encoder_noise, step_jacobian
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE

_RADIUS, _GAUGE = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge


def cycle(
    x: NDArray, P: NDArray, left: float, right: float, yaw: float, M: float, R: float
) -> tuple[NDArray, NDArray]:
    """Pose (3,) and covariance (3, 3) after both sprockets turned and the yaw was measured."""
    s, d = _RADIUS * (left + right) / 2, _RADIUS * (right - left) / _GAUGE
    F, Q = step_jacobian(x[2], s, d, 1.0), encoder_noise(x[2], left, right, M)
    x = x + np.array([s * np.cos(x[2] + d / 2), s * np.sin(x[2] + d / 2), d])
    P = F @ P @ F.T + Q
    K = P[:, 2] / (P[2, 2] + R)
    innovation = np.arctan2(np.sin(yaw - x[2]), np.cos(yaw - x[2]))
    return x + K * innovation, P - np.outer(K, P[2])


def _cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for turns in rng.integers(-2, 3, 30):
        x = rng.uniform((-9, -9, -3), (9, 9, 3))
        A = rng.normal(size=(3, 3)) * (0.5, 0.5, 0.2)
        yaw = float(x[2] + rng.normal(0.0, 0.3) + 2 * np.pi * turns)
        noises = rng.uniform((0.001, 0.005), (0.02, 0.05))
        cases.append((x, A.T @ A, *rng.uniform(0.2, 1.5, 2), yaw, *noises))
    return cases


def _other(
    x: NDArray,
    P: NDArray,
    left: float,
    right: float,
    yaw: float,
    M: float,
    R: float,
    wrap: bool = True,
    after: bool = False,
    carried: bool = True,
    sign: float = 1.0,
    kept: bool = False,
    share: tuple[float, float, float] = (1.0, 1.0, 1.0),
) -> tuple[NDArray, NDArray]:
    """The cycle with one thing done otherwise."""
    s, d = _RADIUS * (left + right) / 2, _RADIUS * (right - left) / _GAUGE
    moved = x + np.array([s * np.cos(x[2] + d / 2), s * np.sin(x[2] + d / 2), d])
    F = step_jacobian((moved if after else x)[2], s, d, 1.0) if carried else np.eye(3)
    P = F @ P @ F.T + encoder_noise((moved if after else x)[2], left, right, M)
    K = P[:, 2] / (P[2, 2] + R) * share
    e = yaw - moved[2]
    e = np.arctan2(np.sin(e), np.cos(e)) if wrap else e
    return moved + sign * K * e, P if kept else P - np.outer(K, P[2])


CYCLE = Exercise(
    number="7.7",
    title="A whole cycle",
    reference=cycle,
    cases=_cases,
    mistakes={
        "the innovation is not wrapped: a yaw of -179 deg is near one of 179 deg": (
            lambda *given: _other(*given, wrap=False)
        ),
        "the two noises are swapped: M is that of the sprockets, R that of the yaw": (
            lambda x, P, left, right, yaw, M, R: cycle(x, P, left, right, yaw, R, M)
        ),
        "R is squared: it is a variance already, not a standard deviation": (
            lambda x, P, left, right, yaw, M, R: cycle(x, P, left, right, yaw, M, R**2)
        ),
        "M is squared: it is a variance already, not a standard deviation": (
            lambda x, P, left, right, yaw, M, R: cycle(x, P, left, right, yaw, M**2, R)
        ),
        "M is not used: the prediction adds the noise of the encoders": (
            lambda x, P, left, right, yaw, M, R: cycle(x, P, left, right, yaw, 0.0, R)
        ),
        "F and Q are taken at the moved pose: (4.21) takes F at the estimate before the step": (
            lambda *given: _other(*given, after=True)
        ),
        "P is not carried by F: an error of the heading grows into one of the place": (
            lambda *given: _other(*given, carried=False)
        ),
        "the covariance is that of the prediction: (4.19) is missing": (
            lambda *given: _other(*given, kept=True)
        ),
        "it turns away from the measured yaw: the innovation is yaw less prediction": (
            lambda *given: _other(*given, sign=-1.0)
        ),
        "only the heading is corrected: x and y err together with it, and P knows how": (
            lambda *given: _other(*given, share=(0.0, 0.0, 1.0))
        ),
        "that is the prediction: the yaw is not used": (
            lambda x, P, left, right, yaw, M, R: _other(
                x, P, left, right, yaw, M, R, sign=0.0, kept=True
            )
        ),
        "R is not used: the heading becomes the measured yaw, noise and all": (
            lambda x, P, left, right, yaw, M, R: cycle(x, P, left, right, yaw, M, 0.0)
        ),
    },
    hints=(
        "s and d as in 7.6, then 7.3 with v T_s = s and omega T_s = d for F, and 7.6 for Q.",
        "H = [[0, 0, 1]]; wrap yaw - x[2], then it is exercise 7.2 with that innovation.",
    ),
    tested_on="30 random poses, some of whose yaws are whole turns away",
)
