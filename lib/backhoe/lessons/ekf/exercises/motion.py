"""Exercises 7.3, 7.6 and 7.7: how a step carries errors on, what encoders add, a whole cycle."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from backhoe.basics import angles
from backhoe.lessons.exercise import Exercise
from backhoe.localisation import kalman, odometry
from backhoe.machine import BACKHOE
from backhoe.vehicle.tracks import tracks_twist

_RADIUS, _GAUGE = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge


def heading_jacobian(psi: float, b: float, v: float, omega: float, T_s: float) -> NDArray:
    """Derivative of a step by x, y, psi and the gyroscope's bias b, shape (4, 4)."""
    turn = (omega - b) * T_s
    s, middle = v * T_s, psi + turn / 2
    F = np.eye(4)
    F[0, 2:] = -s * np.sin(middle), s * np.sin(middle) * T_s / 2
    F[1, 2:] = s * np.cos(middle), -s * np.cos(middle) * T_s / 2
    F[2, 3] = -T_s
    return F


def _mixed(
    rng: np.random.Generator, low: tuple, high: tuple, count: int, still: Sequence[tuple]
) -> list[tuple]:
    """Random arguments of both signs, and those that are named."""
    cases = [tuple(map(float, rng.uniform(low, high))) for _ in range(count)]
    return [*cases, *still]


def _jacobian(
    psi: float,
    b: float,
    v: float,
    omega: float,
    T_s: float,
    share: float = 0.5,
    way: Callable = lambda v, T_s: v * T_s,
    turned: Callable = lambda omega, b: omega - b,
    by_psi: Callable = lambda s, sin, cos: (-s * sin, s * cos),
    by_b: Callable = lambda x, y, turn: (x, y, turn),
    identity: float = 1.0,
) -> NDArray:
    """The Jacobian with another share of the turn, way, turn, columns or diagonal."""
    middle, s = psi + share * turned(omega, b) * T_s, way(v, T_s)
    sin, cos = np.sin(middle), np.cos(middle)
    F = identity * np.eye(4)
    F[:2, 2] = by_psi(s, sin, cos)
    F[:3, 3] = by_b(s * sin * T_s / 2, -s * cos * T_s / 2, -T_s)
    return F


def _without_T_s(x: float, y: float, turn: float) -> tuple[float, float, float]:
    return 0.0, 0.0, -1.0


JACOBIAN = Exercise(
    number="7.3",
    title="A heading by gyroscope",
    reference=heading_jacobian,
    cases=partial(
        _mixed,
        low=(-3.0, -0.2, -1.5, -0.9, 0.02),
        high=(3.0, 0.2, 1.5, 0.9, 0.5),
        count=40,
        still=((0.0, 0.0, 0.0, 0.0, 0.1), (1.0, 0.1, 0.0, 0.4, 0.2), (-2.0, 0.1, -0.8, 0.1, 0.3)),
    ),
    oracle="the_derivative_of_the_step",
    mistakes={
        "T_s is missing: v is metres a second, the step is v T_s metres": (
            partial(_jacobian, way=lambda v, T_s: v)
        ),
        "sine and cosine are swapped: the derivative of the cosine is minus the sine": (
            partial(_jacobian, by_psi=lambda s, sin, cos: (-s * cos, s * sin))
        ),
        "that is the step itself, cosine and sine: differentiate it by psi": (
            partial(_jacobian, by_psi=lambda s, sin, cos: (s * cos, s * sin))
        ),
        "the minus of the first row is missing: d cos/d psi = -sin": (
            partial(_jacobian, by_psi=lambda s, sin, cos: (s * sin, s * cos))
        ),
        "the column of psi has its signs turned: minus the sine in x, plus the cosine in y": (
            partial(_jacobian, by_psi=lambda s, sin, cos: (s * sin, -s * cos))
        ),
        "the heading is that of the start: half of the turn belongs to it": (
            partial(_jacobian, share=0.0)
        ),
        "the heading is that of the end: take half of the turn": partial(_jacobian, share=1.0),
        "the bias adds to the turn here: the machine turns by (omega - b) T_s": (
            partial(_jacobian, turned=lambda omega, b: omega + b)
        ),
        "the bias is not used in the heading: the machine turns by (omega - b) T_s": (
            partial(_jacobian, turned=lambda omega, b: omega)
        ),
        "the bias moves x and y, too: it is in the middle heading, with -T_s/2": (
            partial(_jacobian, by_b=lambda x, y, turn: (0.0, 0.0, turn))
        ),
        "the half of the chain rule is missing: d middle/d b = -T_s/2": (
            partial(_jacobian, by_b=lambda x, y, turn: (2 * x, 2 * y, turn))
        ),
        "the bias's column has its signs turned: more bias is less turn": (
            partial(_jacobian, by_b=lambda x, y, turn: (-x, -y, -turn))
        ),
        "an error of the bias does not turn the machine there: row psi has -T_s": (
            partial(_jacobian, by_b=lambda x, y, turn: (x, y, 0.0))
        ),
        "x and y of the bias's column have the wrong sign: two minus signs make a plus in x": (
            partial(_jacobian, by_b=lambda x, y, turn: (-x, -y, turn))
        ),
        "row psi has -1 for the bias: over a step it turns by -T_s": (
            partial(_jacobian, by_b=lambda x, y, turn: (x, y, -1.0))
        ),
        "the column of the bias is missing: its errors turn and move the machine": (
            partial(_jacobian, by_b=lambda x, y, turn: (0.0, 0.0, 0.0))
        ),
        "the identity is missing: an error of x before the step is one after it": (
            partial(_jacobian, identity=0.0)
        ),
        "that is the derivative of the rate: a discrete F has an identity and T_s": (
            partial(_jacobian, share=0.0, way=lambda v, T_s: v, by_b=_without_T_s, identity=0.0)
        ),
        "v T_s counts as positive: the tracks may run backwards": (
            partial(_jacobian, way=lambda v, T_s: abs(v) * T_s)
        ),
        "the turn counts as positive: the machine turns to the right as well": (
            partial(_jacobian, turned=lambda omega, b: abs(omega - b))
        ),
        "it is transposed: row x, column psi says what an error of psi does to x": (
            lambda *step: heading_jacobian(*step).T
        ),
        "psi, b and omega are in radians already": (
            lambda psi, b, v, omega, T_s: heading_jacobian(
                np.radians(psi), np.radians(b), v, np.radians(omega), T_s
            )
        ),
    },
    hints=(
        "x + v T_s cos(psi + (omega - b) T_s/2): differentiate by x, by y, by psi, by b.",
        "Ones on the diagonal; column psi: -s sin, s cos of the middle; column b: that, by -T_s/2.",
    ),
    tested_on="43 steps forwards and back, to both sides, and at rest",
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
    mean: float = 0.5,
    change: Callable = lambda s, d: (s, d),
    sides: Callable = lambda G: G,
) -> NDArray:
    """The noise with other shares of the turn, gauge, way, sides that err together."""
    s, d = change(*tracks_twist(left, right))
    cos, sin = np.cos(psi + share * d), np.sin(psi + share * d)
    G = np.array([[cos, -lever * s * sin], [sin, lever * s * cos], [0, 1]])
    G = sides(G @ (_RADIUS * np.array([[mean, mean], [-1 / gauge, 1 / gauge]])))
    return variance * G @ [[1, together], [together, 1]] @ G.T


def _varied(change: Callable) -> Callable:
    return lambda psi, left, right, variance: encoder_noise(psi, left, right, change(variance))


NOISE = Exercise(
    number="7.6",
    title="Noise of the encoders in the pose",
    reference=encoder_noise,
    cases=partial(
        _mixed,
        low=(-3.0, -1.5, -1.5, 0.01),
        high=(3.0, 1.5, 1.5, 0.3),
        count=30,
        still=((0.0, 0.0, 0.0, 0.02), (0.8, 1.0, -1.0, 0.1), (-2.0, -0.5, -0.5, 0.0)),
    ),
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
        "the way is the mean of both sides, r (left + right)/2: the half is missing": (
            partial(_noise, mean=1.0)
        ),
        "the mean heading has half of the turn, psi + d/2: yours has all of it": (
            partial(_noise, share=1.0)
        ),
        "the mean heading has half of the turn, psi + d/2: yours has none of it": (
            partial(_noise, share=0.0)
        ),
        "the turn is to the left for right > left: d = r (right - left)/l": (
            partial(_noise, change=lambda s, d: (s, -d))
        ),
        "the turn counts as positive: the machine turns to the right as well": (
            partial(_noise, change=lambda s, d: (s, abs(d)))
        ),
        "the way counts as positive: the tracks may run backwards": (
            partial(_noise, change=lambda s, d: (abs(s), d))
        ),
        "all of the turn moves the way: an error of d turns it by d/2": (
            partial(_noise, lever=1.0)
        ),
        "all of the turn is in the middle heading, and in its derivative: d/2": (
            partial(_noise, share=1.0, lever=1.0)
        ),
        "the gauge is counted twice: the turn is r (right - left)/l": (
            partial(_noise, gauge=2 * _GAUGE, change=lambda s, d: (s, d / 2))
        ),
        "that takes half the gauge: the turn is r (right - left)/l": (
            partial(_noise, gauge=_GAUGE / 2, change=lambda s, d: (s, 2 * d))
        ),
        "r is missing in the way and the turn, too: a sprocket's radian is r metres": (
            lambda psi, left, right, variance: encoder_noise(
                psi, left / _RADIUS, right / _RADIUS, variance / _RADIUS**2
            )
        ),
        "the sprockets' turns count as positive: the tracks may run backwards": (
            lambda psi, left, right, variance: encoder_noise(psi, abs(left), abs(right), variance)
        ),
        "only one side errs: each of the two has its noise, and they add": (
            partial(_noise, sides=lambda G: G * (1, 0))
        ),
    },
    hints=(
        "s = r (left + right)/2, d = r (right - left)/l; x, y, psi change with s and d.",
        "G is d(x, y, psi)/d(left, right), shape (3, 2), by the chain rule; Q = variance G G^T.",
    ),
    tested_on="33 steps forwards and back, on the spot and at rest",
)


def cycle(
    x: NDArray, P: NDArray, left: float, right: float, yaw: float, M: float, R: float
) -> tuple[NDArray, NDArray]:
    """Pose (3,) and covariance (3, 3) after both sprockets turned and the yaw was measured."""
    s, d = tracks_twist(left, right)
    F = heading_jacobian(x[2], 0.0, s, d, 1.0)[:3, :3]
    Q = encoder_noise(x[2], left, right, M)
    x = odometry.advance(x, s, d, "midpoint")
    z = x[2] + angles.wrap(yaw - x[2])
    return kalman.update(x, F @ P @ F.T + Q, [z], [[0, 0, 1]], [[R]])


def _cycles(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for turns in rng.integers(-2, 3, 30):
        x = rng.uniform((-9, -9, -3), (9, 9, 3))
        A = rng.normal(size=(3, 3)) * (0.5, 0.5, 0.2)
        yaw = float(x[2] + rng.normal(0.0, 0.3) + 2 * np.pi * turns)
        noises = map(float, rng.uniform((0.001, 0.005), (0.02, 0.05)))
        sides = map(float, rng.uniform(-1.5, 1.5, 2))
        cases.append((x, A.T @ A, *sides, yaw, *noises))
    x, P = np.array([1.0, -2.0, 3.1]), np.diag([0.04, 0.01, 0.02])
    still = [(x, P, 0.0, 0.0, -3.1, 0.0, 0.02), (-x, P, 0.0, 0.0, 3.1, 0.01, 0.02)]
    return [*cases, *still, (np.zeros(3), P, -1.0, 1.0, 0.0, 0.01, 0.05)]


def _driven_by(x: NDArray, s: float, d: float, rule: str = "midpoint") -> NDArray:
    return odometry.advance(x, s, d, rule)


def _driven(x: NDArray, left: float, right: float) -> NDArray:
    return _driven_by(x, *map(float, tracks_twist(left, right)))


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
    rule: str = "midpoint",
    sides: Callable = lambda left, right: (left, right),
    before: bool = False,
    noise: Callable = encoder_noise,
    slope: float = 0.5,
    turn: float = 1.0,
) -> tuple[NDArray, NDArray]:
    """The cycle with one thing done otherwise."""
    left, right = sides(left, right)
    s, d = tracks_twist(left, right)
    d = turn * d
    moved = (
        odometry.advance(np.add(x, (0.0, 0.0, d)), s, 0.0)
        if rule == "end"
        else _driven_by(x, s, d, rule)
    )
    psi = (moved if after else x)[2]
    seen_at = psi + (slope - 0.5) * d
    F = heading_jacobian(seen_at, 0.0, s, d, 1.0)[:3, :3] if carried else np.eye(3)
    P = F @ P @ F.T + noise(psi, left, right, M)
    K = P[:, 2] / (P[2, 2] + R) * share
    seen = (x if before else moved)[2]
    return moved + sign * K * wrap(yaw - seen), P if kept else P - np.outer(K, P[2])


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
        "wrapped to 0 ... 2 pi, a small turn to the right becomes nearly a whole one: -pi ... pi": (
            partial(_other, wrap=lambda angle: angle % (2 * np.pi))
        ),
        "that puts M's standard deviation where its variance belongs": (
            _noises(lambda M, R: (np.sqrt(M), R))
        ),
        "that puts R's standard deviation where its variance belongs": (
            _noises(lambda M, R: (M, np.sqrt(R)))
        ),
        "the heading of the way is that of the start, and F's too: take the middle of the turn": (
            partial(_other, rule="euler", slope=0.0)
        ),
        "the heading of the way is that of the end: take the middle of the turn": (
            partial(_other, rule="end", slope=1.0)
        ),
        "the turn is to the left for right > left: d = r (right - left)/l": (
            partial(_other, turn=-1.0)
        ),
        "only the heading is corrected, and P says that all are: x and y err with it": (
            lambda x, P, *rest: (
                np.append(_driven(x, *rest[:2])[:2], cycle(x, P, *rest)[0][2]),
                cycle(x, P, *rest)[1],
            )
        ),
        "the covariance is the old one: predict it, and update it": (
            lambda x, P, *rest: (cycle(x, P, *rest)[0], P)
        ),
        "the innovation counts as positive: a yaw to the right turns to the right": (
            partial(_other, wrap=lambda angle: abs(angles.wrap(angle)))
        ),
        "the yaw is compared with the heading before the step: predict first": (
            partial(_other, before=True)
        ),
        "the way is that of the heading at the start: take the middle of the turn": (
            partial(_other, rule="euler")
        ),
        "left and right are swapped: the machine turns to the left for right > left": (
            partial(_other, sides=lambda left, right: (right, left))
        ),
        "the sprockets' turns count as positive: the tracks may run backwards": (
            partial(_other, sides=lambda left, right: (abs(left), abs(right)))
        ),
        "M goes onto x, y and psi as it is: G of 7.6 carries the sprockets' noise there": (
            partial(_other, noise=lambda psi, left, right, M: M * np.eye(3))
        ),
    },
    hints=(
        "s and d as in 7.6, then 7.3 with v T_s = s and omega T_s = d for F, and 7.6 for Q.",
        "H = [[0, 0, 1]]; wrap yaw - x[2], then it is exercise 7.2 with that innovation.",
    ),
    tested_on="33 poses, forwards, back and at rest, some of whose yaws are whole turns away",
)
