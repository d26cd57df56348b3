"""Exercises 4.1 to 4.3: wheel speeds, what slips sideways, the effective half track."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.vehicle.skid_steer import HUSKY

_RADIUS, _TRACK = HUSKY.wheel_radius, 2 * HUSKY.half_track


def wheel_speeds(v: float, omega: float) -> NDArray:
    """Speeds of the Husky's left and right wheels for a twist (2.2), shape (2,) [rad/s]."""
    turn = omega * HUSKY.half_track
    return np.array([v - turn, v + turn]) / HUSKY.wheel_radius


def _wheels(v: float, omega: float, half_track: float = HUSKY.half_track) -> NDArray:
    return np.array([v - omega * half_track, v + omega * half_track]) / _RADIUS


WHEELS = Exercise(
    number="4.1",
    title="From a twist to wheel speeds",
    reference=wheel_speeds,
    cases=lambda rng: [tuple(rng.uniform((-1.0, -1.5), (1.0, 1.5))) for _ in range(40)],
    mistakes={
        "it turns twice as fast as asked: c is half the distance between left and right": (
            lambda v, omega: _wheels(v, omega, _TRACK)
        ),
        "it turns half as fast as asked: c is half the distance already, do not halve it again": (
            lambda v, omega: _wheels(v, omega, _TRACK / 4)
        ),
        "left and right are swapped: a left turn needs the faster wheels on the right": (
            lambda v, omega: wheel_speeds(v, omega)[::-1]
        ),
        "these are speeds of the rims in m/s: divide by the radius to get rad/s": (
            lambda v, omega: wheel_speeds(v, omega) * _RADIUS
        ),
        "a larger wheel turns more slowly at the same speed: divide by r": (
            lambda v, omega: wheel_speeds(v, omega) * _RADIUS**2
        ),
        "only the turn is divided by r: brackets round v -+ c omega": (
            lambda v, omega: np.array(
                [v - omega * _TRACK / 2 / _RADIUS, v + omega * _TRACK / 2 / _RADIUS]
            )
        ),
        "these are revolutions a minute: the wheels' speeds come in rad/s": (
            lambda v, omega: wheel_speeds(v, omega) * 30 / np.pi
        ),
        "both sides get the same speed, so it never turns: what does omega do to each side?": (
            lambda v, omega: np.full(2, v / _RADIUS)
        ),
    },
    hints=(
        "The left wheels are c to the left of the middle: at omega they move back by c omega.",
        "v_left = v - c omega and v_right = v + c omega in m/s; then divide by the wheel's radius.",
    ),
    tested_on="40 random twists",
)


def side_slip(omega: float, x_icr: float) -> NDArray:
    """Lateral speeds of the Husky's front and rear wheels over the ground, shape (2,) [m/s]."""
    v_y = -x_icr * omega
    return np.array([v_y + HUSKY.front * omega, v_y - HUSKY.rear * omega])


SIDE_SLIP = Exercise(
    number="4.2",
    title="What slips sideways",
    reference=side_slip,
    cases=lambda rng: [tuple(rng.uniform((-1.5, -0.24), (1.5, 0.24))) for _ in range(40)],
    mistakes={
        "(2.5) says v_y = -x_ICR omega: you have the other sign of x_ICR": (
            lambda omega, x_icr: side_slip(omega, -x_icr)
        ),
        "that is v_y of the centre of mass: a wheel ahead of it also moves with the turn": (
            lambda omega, x_icr: np.full(2, -x_icr * omega)
        ),
        "x_ICR has no effect: the wheel's distance to the centre of rotation counts": (
            lambda omega, x_icr: side_slip(omega, 0.0)
        ),
        "the rear wheels are behind the centre of mass: theirs is -b, not +b": (
            lambda omega, x_icr: side_slip(omega, x_icr)[[0, 0]]
        ),
        "front and rear are swapped: in a left turn the front moves to the left": (
            lambda omega, x_icr: side_slip(omega, x_icr)[::-1]
        ),
        "that takes c, the distance to the side: sideways a wheel moves by its x, a or -b": (
            lambda omega, x_icr: omega * (np.array([1, -1]) * HUSKY.half_track - x_icr)
        ),
        "these are distances in m: how fast does the vehicle turn about the centre?": (
            lambda omega, x_icr: np.array([HUSKY.front - x_icr, -HUSKY.rear - x_icr])
        ),
    },
    hints=(
        "A point at (x, y) of a turning body moves sideways with v_y + omega x.",
        "v_y = -x_icr omega from (2.5); x is HUSKY.front for the front, -HUSKY.rear for the rear.",
    ),
    tested_on="40 random turns",
)


def half_track(t: NDArray, left: NDArray, right: NDArray, turn: float) -> float:
    """Effective half track from a turn on the spot: (2.7) with the wheel radius [m]."""
    angle = np.trapezoid(right - left, t)
    return HUSKY.wheel_radius * angle / (2 * turn)


def _spins(rng: np.random.Generator) -> list[tuple]:
    """Spins that start and end at rest: time, speeds of both sides, angle turned."""
    cases = []
    for _ in range(12):
        t = np.linspace(0.0, rng.uniform(3.0, 9.0), rng.integers(200, 600))
        shape = np.sin(np.pi * t / t[-1]) ** 2
        left, right = -rng.uniform(0.5, 3.0) * shape, rng.uniform(0.5, 3.0) * shape
        true = rng.uniform(0.3, 0.7)
        turn = HUSKY.wheel_radius * np.trapezoid(right - left, t) / (2 * true)
        cases.append((t, left, right, float(turn)))
    return cases


def _scaled(t: NDArray, left: NDArray, right: NDArray, turn: float, factor: float) -> float:
    return factor * half_track(t, left, right, turn)


HALF_TRACK = Exercise(
    number="4.3",
    title="Repair (2.7)",
    reference=half_track,
    cases=_spins,
    mistakes={
        "that is (2.7) as printed, an angle by an angle: the wheel's radius makes it a length": (
            lambda t, left, right, turn: _scaled(t, left, right, turn, 1 / _RADIUS)
        ),
        "that is the whole effective track: half of it is asked": (
            lambda t, left, right, turn: _scaled(t, left, right, turn, 2.0)
        ),
        "it is negative: right minus left, for a turn to the left": (
            lambda t, left, right, turn: _scaled(t, left, right, turn, -1.0)
        ),
        "only the right side is used: the left wheels did not turn exactly as fast backwards": (
            lambda t, left, right, turn: half_track(t, -right, right, turn)
        ),
        "a sum of speeds is no angle: each sample counts for its time step": (
            lambda t, left, right, turn: _RADIUS * np.sum(right - left) / (2 * turn)
        ),
        "the turn is in radians already": (
            lambda t, left, right, turn: half_track(t, left, right, np.degrees(turn))
        ),
        "that takes the highest speeds for all of the time: integrate them": (
            lambda t, left, right, turn: _RADIUS * np.max(right - left) * t[-1] / (2 * turn)
        ),
        "that is the half track of the drawing: the spins tell another one": (
            lambda t, left, right, turn: HUSKY.half_track
        ),
    },
    hints=(
        "Each rim ran r times the angle of its wheel. Without slip, what would the turn have been?",
        "np.trapezoid(right - left, t) is an angle; times r, over twice the turn, it is a length.",
    ),
    tested_on="12 spins that were simulated with half tracks from 0.3 to 0.7 m",
)
