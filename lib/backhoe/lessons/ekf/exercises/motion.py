"""Exercises 7.3, 7.6 and 7.7: how a step carries errors on, what encoders add, a whole cycle."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from backhoe.basics import angles
from backhoe.lessons.exercise import Exercise
from backhoe.localisation import kalman, odometry
from backhoe.machine import BACKHOE
from backhoe.vehicle.tracks import tracks_twist

_RADIUS, _GAUGE = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge


def step_jacobian(psi: float, v: float, omega: float, T_s: float) -> NDArray:
    """Derivative of (4.24) repaired, for x, y, psi, shape (3, 3): (4.25) repaired."""
    middle = psi + omega * T_s / 2
    F = np.eye(3)
    F[0, 2] = -v * T_s * np.sin(middle)
    F[1, 2] = v * T_s * np.cos(middle)
    return F


def _uniform(rng: np.random.Generator, low: tuple, high: tuple, count: int) -> list[tuple]:
    return [tuple(rng.uniform(low, high)) for _ in range(count)]


def _jacobian(
    psi: float,
    v: float,
    omega: float,
    T_s: float,
    column: Callable = lambda right, T_s: right,
    share: float = 0.5,
    identity: float = 1.0,
) -> NDArray:
    """The Jacobian with column(-sine and cosine times v T_s, T_s), a share of the turn."""
    seen, F = psi + share * omega * T_s, identity * np.eye(3)
    F[:2, 2] = column(v * T_s * np.array([-np.sin(seen), np.cos(seen)]), T_s)
    return F


JACOBIAN = Exercise(
    number="7.3",
    title="Repair (4.25)",
    reference=step_jacobian,
    cases=partial(_uniform, low=(-3.0, 0.3, 0.3, 0.02), high=(3.0, 1.5, 0.9, 0.5), count=40),
    oracle="the_derivative_of_the_step",
    mistakes={
        "T_s is missing, as in (4.25): v is metres a second, the step is v T_s metres": (
            partial(_jacobian, column=lambda right, T_s: right / T_s)
        ),
        "sine and cosine are swapped: the derivative of the cosine is minus the sine": (
            partial(_jacobian, column=lambda right, T_s: -right[::-1])
        ),
        "that is the step itself, cosine and sine: differentiate it by psi": (
            partial(_jacobian, column=lambda right, T_s: right[::-1] * (1, -1))
        ),
        "the minus of the first row is missing: d cos/d psi = -sin": (
            partial(_jacobian, column=lambda right, T_s: right * (-1, 1))
        ),
        "both signs are turned round: minus the sine in x, plus the cosine in y": (
            partial(_jacobian, column=lambda right, T_s: -right)
        ),
        "the heading is that of the start: (4.25) rightly has that of the middle": (
            partial(_jacobian, share=0.0)
        ),
        "the heading is that of the end, as in (4.24): take half of the turn": (
            partial(_jacobian, share=1.0)
        ),
        "that is df/dx of the rate (4.20): a discrete F has an identity and T_s": (
            partial(_jacobian, column=lambda right, T_s: right / T_s, share=0.0, identity=0.0)
        ),
        "the identity is missing: an error of x before the step is one after it": (
            partial(_jacobian, identity=0.0)
        ),
        "it is transposed: row x, column psi says what an error of psi does to x": (
            lambda *step: step_jacobian(*step).T
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
    s, d = tracks_twist(left, right)
    cos, sin = np.cos(psi + d / 2), np.sin(psi + d / 2)
    of_s_and_d = np.array([[cos, -s * sin / 2], [sin, s * cos / 2], [0, 1]])
    of_sides = _RADIUS * np.array([[1 / 2, 1 / 2], [-1 / _GAUGE, 1 / _GAUGE]])
    G = of_s_and_d @ of_sides
    return variance * G @ G.T


def _noise(
    psi: float,
    left: float,
    right: float,
    variance: float,
    share: float = 0.5,
    lever: float = 0.5,
    gauge: float = _GAUGE,
    together: float = 0.0,
) -> NDArray:
    """The noise with other shares of the turn, another gauge, sides that err together."""
    s, d = tracks_twist(left, right)
    cos, sin = np.cos(psi + share * d), np.sin(psi + share * d)
    G = np.array([[cos, -lever * s * sin], [sin, lever * s * cos], [0, 1]])
    G = G @ (_RADIUS * np.array([[1 / 2, 1 / 2], [-1 / gauge, 1 / gauge]]))
    return variance * G @ [[1, together], [together, 1]] @ G.T


def _varied(change: Callable) -> Callable:
    return lambda psi, left, right, variance: encoder_noise(psi, left, right, change(variance))


NOISE = Exercise(
    number="7.6",
    title="Noise of the encoders in the pose",
    reference=encoder_noise,
    cases=partial(_uniform, low=(-3.0, 0.3, 0.3, 0.01), high=(3.0, 1.5, 1.5, 0.3), count=30),
    oracle="the_noise_through_the_derivative_by_the_sides",
    mistakes={
        "that puts a standard deviation where a variance belongs": _varied(np.sqrt),
        "the variance is squared: G takes it as it is, G M G^T": _varied(np.square),
        "the noise is in radians of the sprocket: r makes metres of it, r^2 square metres": (
            _varied(lambda variance: variance / _RADIUS**2)
        ),
        "both sides err alike and the heading never: the encoders' noises are independent": (
            partial(_noise, together=1.0)
        ),
        "the heading's noise is twice too large: the turn is r (right - left)/l, l the gauge": (
            partial(_noise, gauge=_GAUGE / 2)
        ),
        "half of the turn is missing: an error of d also turns the way, by d/2": (
            partial(_noise, share=0.0, lever=0.0)
        ),
        "x and y change with the turn, too: differentiate the d/2 in their cosine and sine": (
            partial(_noise, lever=0.0)
        ),
        "only the variances are kept: an error of one sprocket moves x, y and psi together": (
            lambda *step: np.diag(np.diag(encoder_noise(*step)))
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


def cycle(
    x: NDArray, P: NDArray, left: float, right: float, yaw: float, M: float, R: float
) -> tuple[NDArray, NDArray]:
    """Pose (3,) and covariance (3, 3) after both sprockets turned and the yaw was measured."""
    s, d = tracks_twist(left, right)
    F, Q = step_jacobian(x[2], s, d, 1.0), encoder_noise(x[2], left, right, M)
    x = odometry.advance(x, s, d, "midpoint")
    z = x[2] + angles.wrap(yaw - x[2])
    return kalman.update(x, F @ P @ F.T + Q, [z], [[0, 0, 1]], [[R]])


def _cycles(rng: np.random.Generator) -> list[tuple]:
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
    wrap: Callable = angles.wrap,
    after: bool = False,
    carried: bool = True,
    sign: float = 1.0,
    kept: bool = False,
    share: tuple[float, float, float] = (1.0, 1.0, 1.0),
) -> tuple[NDArray, NDArray]:
    """The cycle with one thing done otherwise."""
    s, d = tracks_twist(left, right)
    moved = odometry.advance(x, s, d, "midpoint")
    psi = (moved if after else x)[2]
    F = step_jacobian(psi, s, d, 1.0) if carried else np.eye(3)
    P = F @ P @ F.T + encoder_noise(psi, left, right, M)
    K = P[:, 2] / (P[2, 2] + R) * share
    return moved + sign * K * wrap(yaw - moved[2]), P if kept else P - np.outer(K, P[2])


def _noises(change: Callable) -> Callable:
    return lambda *given: cycle(*given[:5], *change(*given[5:]))


CYCLE = Exercise(
    number="7.7",
    title="A whole cycle",
    reference=cycle,
    cases=_cycles,
    oracle="the_joint_normal_of_the_moved_pose_and_its_yaw",
    mistakes={
        "the innovation is not wrapped: a yaw of -179 deg is near one of 179 deg": (
            partial(_other, wrap=float)
        ),
        "the two noises are swapped: M is that of the sprockets, R that of the yaw": (
            _noises(lambda M, R: (R, M))
        ),
        "R is squared: it is a variance already, not a standard deviation": (
            _noises(lambda M, R: (M, R**2))
        ),
        "M is squared: it is a variance already, not a standard deviation": (
            _noises(lambda M, R: (M**2, R))
        ),
        "M is not used: the prediction adds the noise of the encoders": (
            _noises(lambda M, R: (0.0, R))
        ),
        "F and Q are taken at the moved pose: (4.21) takes F at the estimate before the step": (
            partial(_other, after=True)
        ),
        "P is not carried by F: an error of the heading grows into one of the place": (
            partial(_other, carried=False)
        ),
        "the covariance is that of the prediction: (4.19) is missing": partial(_other, kept=True),
        "it turns away from the measured yaw: the innovation is yaw less prediction": (
            partial(_other, sign=-1.0)
        ),
        "only the heading is corrected: x and y err together with it, and P knows how": (
            partial(_other, share=(0.0, 0.0, 1.0))
        ),
        "that is the prediction: the yaw is not used": partial(_other, sign=0.0, kept=True),
        "R is not used: the heading becomes the measured yaw, noise and all": (
            _noises(lambda M, R: (M, 0.0))
        ),
    },
    hints=(
        "s and d as in 7.6, then 7.3 with v T_s = s and omega T_s = d for F, and 7.6 for Q.",
        "H = [[0, 0, 1]]; wrap yaw - x[2], then it is exercise 7.2 with that innovation.",
    ),
    tested_on="30 random poses, some of whose yaws are whole turns away",
)
