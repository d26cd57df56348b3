"""Exercises 5.3 and 5.4: the errors of a pose; limits that let the turn go first."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import atan, atan2, cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.angles import wrap
from backhoe.lessons.exercise import Exercise
from backhoe.vehicle.tracking import Limits, PoseErrors, pose_errors


def _pose_cases(rng: np.random.Generator) -> list[tuple]:
    low, high = (-3, -3, -7, -3, -3, -1, -1), (3, 3, 7, 3, 3, 1, 1)
    rows = rng.uniform(low, high, (60, 7))
    return [(row[:3], row[3:5], row[3:5] + row[5:]) for row in rows]


def _with(**changes: Callable[[float, NDArray, NDArray, PoseErrors], float]) -> Callable:
    """The errors with one worked out anew from theta, the ways to and on from the way-point."""

    def wrong(pose: NDArray, waypoint: NDArray, next_waypoint: NDArray) -> PoseErrors:
        right = pose_errors(pose, waypoint, next_waypoint)
        ways = pose[2], waypoint - pose[:2], next_waypoint - waypoint
        return right._replace(**{name: change(*ways, right) for name, change in changes.items()})

    return wrong


def _bearing(way: NDArray) -> float:
    return atan2(way[1], way[0])


def _slope(way: NDArray) -> float:
    return atan(way[1] / way[0])


POSE_ERRORS = Exercise(
    number="5.3",
    title="The errors of a pose",
    reference=pose_errors,
    oracle="seen_from_the_vehicle",
    cases=_pose_cases,
    mistakes={
        "alpha is theta - phi: it must turn the vehicle the way Delta y does": (
            _with(alpha=lambda theta, to, on, e: -e.alpha)
        ),
        "alpha is not wrapped: 350 degrees to the left are 10 to the right": (
            _with(alpha=lambda theta, to, on, e: _bearing(on) - theta)
        ),
        "alpha is theta - phi, and not wrapped: its sign is against Delta y's": (
            _with(alpha=lambda theta, to, on, e: theta - _bearing(on))
        ),
        "alpha is wrapped into 0..2 pi: a small turn to the right becomes nearly a full one": (
            _with(alpha=lambda theta, to, on, e: e.alpha % (2 * pi))
        ),
        "phi is the direction from the way-point to the next one, not from the vehicle": (
            _with(alpha=lambda theta, to, on, e: wrap(_bearing(to + on) - theta))
        ),
        "that is beta in the place of alpha: alpha looks along the segment after the way-point": (
            _with(alpha=lambda theta, to, on, e: wrap(_bearing(to) - theta))
        ),
        "np.arctan cannot tell ahead from behind: use np.arctan2 for beta": (
            _with(dy=lambda theta, to, on, e: e.rho * sin(_slope(to) - theta))
        ),
        "np.arctan cannot tell to from fro: use np.arctan2 for phi": (
            _with(alpha=lambda theta, to, on, e: wrap(_slope(on) - theta))
        ),
        (
            "that is Delta Y, along the map: take theta off beta, Delta y is to the left of the "
            "vehicle"
        ): _with(dy=lambda theta, to, on, e: to[1]),
        "Delta y is a length: rho times the sine of beta": (
            _with(dy=lambda theta, to, on, e: e.dy / e.rho)
        ),
        "that is how far ahead the way-point lies: how far aside is the sine": (
            _with(dy=lambda theta, to, on, e: e.rho * cos(_bearing(to) - theta))
        ),
        "Delta y is positive to the left, like y itself": (
            _with(dy=lambda theta, to, on, e: -e.dy)
        ),
        "alpha is in degrees: everything inside the course is in radians": (
            _with(alpha=lambda theta, to, on, e: np.degrees(e.alpha))
        ),
        "alpha has a sign: a bend to the right is negative": (
            _with(alpha=lambda theta, to, on, e: abs(e.alpha))
        ),
        "Delta y has a sign: a way-point to the right lies at a negative one": (
            _with(dy=lambda theta, to, on, e: abs(e.dy))
        ),
        "that is beta in the place of Delta y: rho times the sine of it is a distance": (
            _with(dy=lambda theta, to, on, e: wrap(_bearing(to) - theta))
        ),
        "the arguments of arctan2 are the wrong way round in phi: first Y, then X": (
            _with(alpha=lambda theta, to, on, e: wrap(_bearing(on[::-1]) - theta))
        ),
        "the arguments of arctan2 are the wrong way round in beta: first Y, then X": (
            _with(dy=lambda theta, to, on, e: e.rho * sin(_bearing(to[::-1]) - theta))
        ),
        "that is phi, a direction on the map: take theta off it": (
            _with(alpha=lambda theta, to, on, e: _bearing(on))
        ),
        "theta is taken off phi, not added to it": (
            _with(alpha=lambda theta, to, on, e: wrap(_bearing(on) + theta))
        ),
        "that is phi less beta: take off theta, the heading, and not the bearing": (
            _with(alpha=lambda theta, to, on, e: wrap(_bearing(on) - _bearing(to) + theta))
        ),
        "that is beta in the place of Delta y, and not wrapped: a distance is rho times its sine": (
            _with(dy=lambda theta, to, on, e: _bearing(to) - theta)
        ),
        "the order is rho, Delta y, alpha": (
            _with(dy=lambda theta, to, on, e: e.alpha, alpha=lambda theta, to, on, e: e.dy)
        ),
        "rho is the straight distance, not the sum of the two ways along the axes": (
            _with(rho=lambda theta, to, on, e: float(np.abs(to).sum()))
        ),
        "rho is the root of that: a distance, not its square": (
            _with(rho=lambda theta, to, on, e: e.rho**2)
        ),
    },
    hints=(
        "beta = atan2(Delta Y, Delta X) - theta; Delta y = rho sin(beta) needs no wrapping. Why?",
        "In Figure 3 the course bends to the left of the vehicle's axis: phi > theta, alpha > 0. "
        "Then wrap it.",
    ),
    tested_on="60 random poses and way-points, headings over several turns",
)


def _limit_cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for numbers in rng.uniform((3, 0.1, 0.2), (10, 0.4, 1.2), (60, 3)):
        limits = Limits(*numbers)
        asked = rng.uniform(-1.8, 1.8, 2) * (limits.max_speed, limits.max_turn_rate)
        cases.append((limits, *asked.tolist()))
    limits = Limits(6.0, 0.2, 0.5)
    still = [(0.0, 0.0), (0.0, -1.0), (-0.5, 0.0), (0.0, 9.0), (-3.0, 0.0), (3.0, -9.0)]
    return cases + [(limits, *asked) for asked in still]


def _speed_left(limits: Limits, v: float, omega: float, turn: float) -> NDArray:
    """v cut to what a turn leaves, and omega cut to its own limit."""
    v_max = limits.max_speed - limits.half_track * turn
    return np.array([np.clip(v, -v_max, v_max), limits.apply(0.0, omega)[1]])


def _speed_first(limits: Limits, v: float, omega: float) -> NDArray:
    v = np.clip(v, -limits.max_speed, limits.max_speed)
    omega_max = (limits.max_speed - abs(v)) / limits.half_track
    return np.array([v, np.clip(omega, -omega_max, omega_max)])


def _same_radius(limits: Limits, v: float, omega: float) -> NDArray:
    need = (abs(v) + limits.half_track * abs(omega)) / limits.max_speed
    return np.array([v, omega]) / max(1.0, need)


def _wheels_clipped(limits: Limits, v: float, omega: float) -> NDArray:
    c, top = limits.half_track, limits.max_speed
    left, right = np.clip([v - c * omega, v + c * omega], -top, top)
    return np.array([(left + right) / 2, (right - left) / (2 * c)])


LIMITS = Exercise(
    number="5.4",
    title="The turn goes first",
    reference=Limits.apply,
    oracle="the_nearest_that_the_wheels_can_do",
    cases=_limit_cases,
    mistakes={
        "you let the speed go first and give the turn what is left: it is the other way round": (
            _speed_first
        ),
        (
            "each limit is right alone, but together one wheel is too fast: turning takes its "
            "share from v"
        ): lambda limits, v, omega: _speed_left(limits, v, omega, 0.0),
        "you slow both down by one factor, which keeps the radius: here the turn goes first": (
            _same_radius
        ),
        "that clips the two wheels one by one: v and omega then change in no planned way": (
            _wheels_clipped
        ),
        (
            "v is limited with the omega that was asked for: use the one that is left after its "
            "own limit"
        ): lambda limits, v, omega: _speed_left(limits, v, omega, abs(omega)),
        "a turn to the right takes speed as well: |omega|, without its sign": (
            lambda limits, v, omega: _speed_left(limits, v, omega, limits.apply(0.0, omega)[1])
        ),
        "it never drives backwards: v lies between -v_max and +v_max": (
            lambda limits, v, omega: limits.apply(max(v, 0.0), omega)
        ),
        "c is half the distance of the wheels already: no factor 2": (
            lambda limits, *wish: replace(limits, half_track=2 * limits.half_track).apply(*wish)
        ),
        "wheel_speed is in rad/s: times the wheel's radius it is a speed over the ground": (
            lambda limits, *wish: replace(limits, wheel_radius=1.0).apply(*wish)
        ),
    },
    hints=(
        "First omega between -r/c wheel_speed and +r/c wheel_speed; only then v.",
        "What is left for v: r wheel_speed - c |omega|, with the omega just limited.",
    ),
    tested_on="66 wishes, most of them too fast, some with no speed or no turn",
)
