"""Exercises 5.3 and 5.4: the errors of a pose, repaired; limits that let the turn go first."""

from __future__ import annotations

from math import atan, cos, hypot, pi, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.lessons.exercise import Exercise


def pose_errors(pose: ArrayLike, waypoint: ArrayLike, next_waypoint: ArrayLike) -> NDArray:
    """rho [m], Delta y [m] and alpha [rad] of eq. (5.1), alpha = phi - theta wrapped to -pi..pi."""
    x, y, theta = pose
    to_goal = np.arctan2(waypoint[1] - y, waypoint[0] - x)
    phi = np.arctan2(next_waypoint[1] - waypoint[1], next_waypoint[0] - waypoint[0])
    rho = np.hypot(waypoint[0] - x, waypoint[1] - y)
    alpha = (phi - theta + np.pi) % (2 * np.pi) - np.pi
    return np.array([rho, rho * np.sin(to_goal - theta), alpha])


def _pose_cases(rng: np.random.Generator) -> list[tuple]:
    return [
        (np.append(start, theta), waypoint, waypoint + step)
        for start, waypoint, step, theta in zip(
            rng.uniform(-3, 3, (60, 2)),
            rng.uniform(-3, 3, (60, 2)),
            rng.uniform(-1, 1, (60, 2)),
            rng.uniform(-7, 7, 60),
            strict=True,
        )
    ]


def _changed(index: int, value: object) -> object:
    def wrong(pose: NDArray, waypoint: NDArray, next_waypoint: NDArray) -> NDArray:
        errors = pose_errors(pose, waypoint, next_waypoint)
        errors[index] = value(pose, waypoint, next_waypoint, errors)
        return errors

    return wrong


def _wrapped(angle: float) -> float:
    return (angle + pi) % (2 * pi) - pi


def _bearing(start: NDArray, end: NDArray) -> float:
    return float(np.arctan2(end[1] - start[1], end[0] - start[0]))


def _slope(start: NDArray, end: NDArray) -> float:
    return atan((end[1] - start[1]) / (end[0] - start[0]))


POSE_ERRORS = Exercise(
    number="5.3",
    title="Repair (5.1)",
    reference=pose_errors,
    cases=_pose_cases,
    mistakes={
        "alpha is as printed, theta - phi: it must turn the vehicle the way Delta y does": (
            _changed(2, lambda p, w, n, e: _wrapped(p[2] - _bearing(w, n)))
        ),
        "alpha is not wrapped: 350 degrees to the left are 10 to the right": (
            _changed(2, lambda p, w, n, e: _bearing(w, n) - p[2])
        ),
        "alpha is as printed: its sign is against Delta y's, and it is not wrapped": (
            _changed(2, lambda p, w, n, e: p[2] - _bearing(w, n))
        ),
        "alpha is wrapped into 0..2 pi: a small turn to the right becomes nearly a full one": (
            _changed(2, lambda p, w, n, e: (_bearing(w, n) - p[2]) % (2 * pi))
        ),
        "phi is the direction from the way-point to the next one, not from the vehicle": (
            _changed(2, lambda p, w, n, e: _wrapped(_bearing(p[:2], n) - p[2]))
        ),
        "that is beta in the place of alpha: alpha looks along the segment after the way-point": (
            _changed(2, lambda p, w, n, e: _wrapped(_bearing(p[:2], w) - p[2]))
        ),
        "np.arctan cannot tell ahead from behind: use np.arctan2 for beta": (
            _changed(1, lambda p, w, n, e: e[0] * sin(_slope(p[:2], w) - p[2]))
        ),
        "np.arctan cannot tell to from fro: use np.arctan2 for phi": (
            _changed(2, lambda p, w, n, e: _wrapped(_slope(w, n) - p[2]))
        ),
        (
            "that is Delta Y, along the map: take theta off beta, Delta y is to the left of the "
            "vehicle"
        ): _changed(1, lambda p, w, n, e: w[1] - p[1]),
        "Delta y is a length: rho times the sine of beta": (
            _changed(1, lambda p, w, n, e: e[1] / e[0])
        ),
        "that is how far ahead the way-point lies: how far aside is the sine": (
            _changed(1, lambda p, w, n, e: e[0] * cos(_bearing(p[:2], w) - p[2]))
        ),
        "Delta y is positive to the left, like y itself": _changed(1, lambda p, w, n, e: -e[1]),
        "alpha is in degrees: everything inside the course is in radians": (
            _changed(2, lambda p, w, n, e: np.degrees(e[2]))
        ),
        "rho is the root of that: a distance, not its square": (
            _changed(0, lambda p, w, n, e: hypot(w[0] - p[0], w[1] - p[1]) ** 2)
        ),
    },
    hints=(
        "beta = atan2(Delta Y, Delta X) - theta; Delta y = rho sin(beta) needs no wrapping. Why?",
        "alpha = phi - theta, then (alpha + pi) % (2 pi) - pi.",
    ),
    tested_on="60 random poses and way-points, headings over several turns",
)


def limit(v: float, omega: float, wheel_max: float, r: float, c: float) -> NDArray:
    """v [m/s] and omega [rad/s] that wheels of at most wheel_max [rad/s] can do, turn first."""
    omega_max = r / c * wheel_max
    omega = np.clip(omega, -omega_max, omega_max)
    v_max = r * wheel_max - c * abs(omega)
    return np.array([np.clip(v, -v_max, v_max), omega])


def _limit_cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(60):
        wheel_max, r, c = rng.uniform((3, 0.1, 0.2), (10, 0.4, 1.2))
        asked = rng.uniform(-1.8, 1.8, 2) * (r * wheel_max, r * wheel_max / c)
        cases.append((*asked.tolist(), wheel_max, r, c))
    return cases


def _speed_first(v: float, omega: float, wheel_max: float, r: float, c: float) -> NDArray:
    v = np.clip(v, -r * wheel_max, r * wheel_max)
    omega_max = (r * wheel_max - abs(v)) / c
    return np.array([v, np.clip(omega, -omega_max, omega_max)])


def _each_alone(v: float, omega: float, wheel_max: float, r: float, c: float) -> NDArray:
    top = r * wheel_max
    return np.clip([v, omega], [-top, -top / c], [top, top / c])


def _same_radius(v: float, omega: float, wheel_max: float, r: float, c: float) -> NDArray:
    need = (abs(v) + c * abs(omega)) / (r * wheel_max)
    return np.array([v, omega]) / max(1.0, need)


def _asked_turn(v: float, omega: float, wheel_max: float, r: float, c: float) -> NDArray:
    v_max = r * wheel_max - c * abs(omega)
    return np.array([np.clip(v, -v_max, v_max), limit(v, omega, wheel_max, r, c)[1]])


def _signed_turn(v: float, omega: float, wheel_max: float, r: float, c: float) -> NDArray:
    omega = limit(v, omega, wheel_max, r, c)[1]
    v_max = r * wheel_max - c * omega
    return np.array([np.clip(v, -v_max, v_max), omega])


def _forwards(v: float, omega: float, wheel_max: float, r: float, c: float) -> NDArray:
    return np.maximum(limit(v, omega, wheel_max, r, c), (0.0, -np.inf))


def _wheels_clipped(v: float, omega: float, wheel_max: float, r: float, c: float) -> NDArray:
    wheels = np.clip(np.array([v - c * omega, v + c * omega]) / r, -wheel_max, wheel_max)
    return np.array([r * wheels.sum() / 2, r * (wheels[1] - wheels[0]) / (2 * c)])


LIMITS = Exercise(
    number="5.4",
    title="The turn goes first",
    reference=limit,
    cases=_limit_cases,
    mistakes={
        "you let the speed go first and give the turn what is left: it is the other way round": (
            _speed_first
        ),
        (
            "each limit is right alone, but together one wheel is too fast: turning takes its "
            "share from v"
        ): _each_alone,
        "you slow both down by one factor, which keeps the radius: here the turn goes first": (
            _same_radius
        ),
        "that clips the two wheels one by one: v and omega then change in no planned way": (
            _wheels_clipped
        ),
        (
            "v is limited with the omega that was asked for: use the one that is left after its "
            "own limit"
        ): _asked_turn,
        "a turn to the right takes speed as well: |omega|, without its sign": _signed_turn,
        "it never drives backwards: v lies between -v_max and +v_max": _forwards,
        "c is half the distance of the wheels already: no factor 2": (
            lambda v, omega, wheel_max, r, c: limit(v, omega, wheel_max, r, 2 * c)
        ),
        "wheel_max is in rad/s: times the wheel's radius it is a speed over the ground": (
            lambda v, omega, wheel_max, r, c: limit(v, omega, wheel_max, 1.0, c)
        ),
    },
    hints=(
        "First omega between -r/c wheel_max and +r/c wheel_max; only then v.",
        "What is left for v: r wheel_max - c |omega|, with the omega just limited.",
    ),
    tested_on="60 random wishes, most of them too fast",
)
