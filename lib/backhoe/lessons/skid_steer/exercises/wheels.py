"""Exercises 4.1 to 4.3: wheel speeds, what slips sideways, the effective half track."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.lessons.skid_steer.printed import x_icr_27
from backhoe.vehicle.skid_steer import HUSKY, effective_half_track, wheel_speeds

_R, _C = HUSKY.wheel_radius, HUSKY.half_track

WHEELS = Exercise(
    number="4.1",
    title="From a twist to wheel speeds",
    reference=wheel_speeds,
    oracle="rims_that_meet_the_ground",
    cases=lambda rng: [(rng.uniform((-1.0, -1.5), (1.0, 1.5)),) for _ in range(40)],
    mistakes={
        "it turns twice as fast as asked: c is half the distance between left and right": (
            partial(wheel_speeds, half_track=2 * _C)
        ),
        "it turns half as fast as asked: c is half the distance already, do not halve it again": (
            partial(wheel_speeds, half_track=_C / 2)
        ),
        "left and right are swapped: a left turn needs the faster wheels on the right": (
            lambda twist: wheel_speeds(twist)[::-1]
        ),
        "these are speeds of the rims in m/s: divide by the radius to get rad/s": (
            lambda twist: wheel_speeds(twist) * _R
        ),
        "a larger wheel turns more slowly at the same speed: divide by r": (
            lambda twist: wheel_speeds(twist) * _R**2
        ),
        "only the turn is divided by r: brackets round v -+ c omega": (
            lambda twist: wheel_speeds(twist) + twist[0] * (1 - 1 / _R)
        ),
        "these are revolutions a minute: the wheels' speeds come in rad/s": (
            lambda twist: wheel_speeds(twist) * 30 / np.pi
        ),
        "both sides get the same speed, so it never turns: what does omega do to each side?": (
            lambda twist: wheel_speeds(twist * (1, 0))
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
    oracle="wheels_carried_round_the_centre",
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
            lambda omega, x_icr: omega * (np.array([_C, -_C]) - x_icr)
        ),
        "these are distances in m: how fast does the vehicle turn about the centre?": (
            lambda omega, x_icr: side_slip(1.0, x_icr)
        ),
    },
    hints=(
        "A point at (x, y) of a turning body moves sideways with v_y + omega x.",
        "v_y = -x_icr omega from (2.5); x is HUSKY.front for the front, -HUSKY.rear for the rear.",
    ),
    tested_on="40 random turns",
)


def _spins(rng: np.random.Generator) -> list[tuple]:
    """Spins that start and end at rest: time, speeds of both sides, angle turned."""
    cases = []
    for _ in range(12):
        t = np.linspace(0.0, rng.uniform(3.0, 9.0), rng.integers(200, 600))
        shape = np.sin(np.pi * t / t[-1]) ** 2
        left, right = -rng.uniform(0.5, 3.0) * shape, rng.uniform(0.5, 3.0) * shape
        turn = _R * np.trapezoid(right - left, t) / (2 * rng.uniform(0.3, 0.7))
        cases.append((t, left, right, float(turn)))
    return cases


HALF_TRACK = Exercise(
    number="4.3",
    title="Repair (2.7)",
    reference=effective_half_track,
    oracle="an_ideal_vehicle_of_that_half_track",
    cases=_spins,
    mistakes={
        "that is (2.7) as printed, an angle by an angle: the wheel's radius makes it a length": (
            x_icr_27
        ),
        "that is the whole effective track: half of it is asked": (
            lambda *spin: 2 * effective_half_track(*spin)
        ),
        "it is negative: right minus left, for a turn to the left": (
            lambda *spin: -effective_half_track(*spin)
        ),
        "only the right side is used: the left wheels did not turn exactly as fast backwards": (
            lambda t, left, right, turn: effective_half_track(t, -right, right, turn)
        ),
        "a sum of speeds is no angle: each sample counts for its time step": (
            lambda t, left, right, turn: _R * np.sum(right - left) / (2 * turn)
        ),
        "the turn is in radians already": (
            lambda *spin: effective_half_track(*spin[:3], np.degrees(spin[3]))
        ),
        "that takes the highest speeds for all of the time: integrate them": (
            lambda t, left, right, turn: _R * np.max(right - left) * t[-1] / (2 * turn)
        ),
        "that is the half track of the drawing: the spins tell another one": lambda *spin: _C,
    },
    hints=(
        "Each rim ran r times the angle of its wheel. Without slip, what would the turn have been?",
        "np.trapezoid(right - left, t) is an angle; times r, over twice the turn, it is a length.",
    ),
    tested_on="12 spins that were simulated with half tracks from 0.3 to 0.7 m",
)
