"""Exercises 4.1 to 4.3: wheel speeds, what slips sideways, the effective half track."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.lessons.skid_steer.printed import x_icr_27
from backhoe.vehicle.skid_steer import (
    HUSKY,
    Vehicle,
    effective_half_track,
    replace,
    wheel_speeds,
)

_R, _C = HUSKY.wheel_radius, HUSKY.half_track

WHEELS = Exercise(
    number="4.1",
    title="From a twist to wheel speeds",
    reference=wheel_speeds,
    oracle="rims_that_meet_the_ground",
    cases=lambda rng: [
        (twist * np.array(one),)
        for one in ((1, 1), (1, 0), (0, 1))
        for twist in rng.uniform((-1.0, -1.5), (1.0, 1.5), (14, 2))
    ],
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
        "omega is added to a speed: the lever c makes m/s of rad/s": (
            partial(wheel_speeds, half_track=1.0)
        ),
        "c comes in the wrong way: the farther out, the faster, so multiply omega by it": (
            partial(wheel_speeds, half_track=1 / _C)
        ),
        "only the speed is divided by r: brackets round v -+ c omega": (
            lambda twist: wheel_speeds(twist * np.array([1, _R]))
        ),
        "half the track is halved into c already: the sides are not halved again": (
            lambda twist: wheel_speeds(twist) / 2
        ),
        "one side keeps v and the other has all of the turn: the middle has v, not a side": (
            lambda twist: wheel_speeds(twist) + _C * twist[1] / _R
        ),
        "both sides have the turn alone: v is missing": (
            lambda twist: wheel_speeds(twist * np.array([0, 1]))
        ),
        "a wheel that runs backwards has a negative speed": (
            lambda twist: np.abs(wheel_speeds(twist))
        ),
        "only one side changes its speed: what the one gains in a turn the other loses": (
            lambda twist: wheel_speeds(twist) + np.array([_C * twist[1] / _R, 0])
        ),
        "left and right share the speed: each runs with all of v, not with half of it": (
            lambda twist: wheel_speeds(twist * np.array([0.5, 1]))
        ),
    },
    hints=(
        "The left wheels are c to the left of the middle: at omega they move back by c omega.",
        "v_left = v - c omega and v_right = v + c omega in m/s; then divide by the wheel's radius.",
    ),
    tested_on="42 twists to both sides, ahead and back, straight on and on the spot",
)


def side_slip(omega: float, x_icr: float, vehicle: Vehicle = HUSKY) -> NDArray:
    """Lateral speeds of the front and rear wheels over the ground, shape (2,) [m/s]."""
    v_y = -x_icr * omega
    return np.array([v_y + vehicle.front * omega, v_y - vehicle.rear * omega])


def _turns(rng: np.random.Generator) -> list[tuple]:
    """Turns to both sides about centres before, behind and level with the middle; none at all."""
    cases = []
    for omega, x_icr in rng.uniform((-1.5, -0.24), (1.5, 0.24), (40, 2)).tolist():
        front, rear = rng.uniform(0.15, 0.6, 2).tolist()
        cases.append((omega, x_icr, replace(HUSKY, front=front, rear=rear)))
    return [*cases, (0.0, 0.1, HUSKY), (-0.7, 0.0, HUSKY)]


def _level(omega: float, x_icr: float, vehicle: Vehicle) -> NDArray:
    """With the distance to the side in the place of those along."""
    return omega * (np.array([vehicle.half_track, -vehicle.half_track]) - x_icr)


SIDE_SLIP = Exercise(
    number="4.2",
    title="What slips sideways",
    reference=side_slip,
    oracle="wheels_carried_round_the_centre",
    cases=_turns,
    mistakes={
        "v_y is -x_ICR omega: you have the other sign of x_ICR": (
            lambda omega, x_icr, vehicle: side_slip(omega, -x_icr, vehicle)
        ),
        "that is v_y of the centre of mass: a wheel ahead of it also moves with the turn": (
            lambda omega, x_icr, vehicle: np.full(2, -x_icr * omega)
        ),
        "x_ICR has no effect: the wheel's distance to the centre of rotation counts": (
            lambda omega, x_icr, vehicle: side_slip(omega, 0.0, vehicle)
        ),
        "the rear wheels are behind the centre of mass: theirs is -b, not +b": (
            lambda omega, x_icr, vehicle: omega * (np.array([vehicle.front, vehicle.rear]) - x_icr)
        ),
        "front and rear are swapped: in a left turn the front moves to the left": (
            lambda *turn: side_slip(*turn)[::-1]
        ),
        "a and b are swapped: the front axle is vehicle.front ahead": (
            lambda omega, x_icr, vehicle: side_slip(
                omega, x_icr, replace(HUSKY, front=vehicle.rear, rear=vehicle.front)
            )
        ),
        "that takes c, the distance to the side: sideways a wheel moves by its x, a or -b": _level,
        "these are distances in m: how fast does the vehicle turn about the centre?": (
            lambda omega, x_icr, vehicle: side_slip(1.0, x_icr, vehicle)
        ),
        "these are the Husky's own each time: use the vehicle that you are given": (
            lambda omega, x_icr, vehicle: side_slip(omega, x_icr)
        ),
        "front and rear slip to opposite sides: keep the signs, to the left is positive": (
            lambda *turn: np.abs(side_slip(*turn))
        ),
        "x_ICR is on the other side for the rear: the distance to the centre is -b - x_ICR": (
            lambda omega, x_icr, vehicle: (
                side_slip(omega, x_icr, vehicle) + np.array([0, 2 * x_icr * omega])
            )
        ),
        "x_ICR is no speed: the centre of mass moves sideways with -x_ICR omega": (
            lambda omega, x_icr, vehicle: side_slip(omega, 0.0, vehicle) - x_icr
        ),
        "the rear wheels slip to the other side: theirs is -b - x_ICR, times omega": (
            lambda *turn: side_slip(*turn) * np.array([1, -1])
        ),
        "the rear axle is vehicle.rear behind, not vehicle.front": (
            lambda omega, x_icr, vehicle: side_slip(
                omega, x_icr, replace(HUSKY, front=vehicle.front, rear=vehicle.front)
            )
        ),
        "to the left is positive: v_y + omega x, with this sign": lambda *turn: -side_slip(*turn),
        "only the one axle moves with the centre of mass: v_y counts for both": (
            lambda omega, x_icr, vehicle: (
                side_slip(omega, x_icr, vehicle) + np.array([0, x_icr * omega])
            )
        ),
    },
    hints=(
        "A point at (x, y) of a turning body moves sideways with v_y + omega x.",
        "v_y = -x_icr omega; x is vehicle.front for the front, -vehicle.rear for the rear.",
    ),
    tested_on="40 random turns of vehicles with axles of any place, one turn level, one none",
)


def _records(rng: np.random.Generator) -> list[tuple]:
    """Records to both sides, sampled evenly or not, begun at any time, in motion at both ends."""
    cases = []
    for k in range(16):
        n, sign = int(rng.integers(40, 90)), 1 if k % 2 else -1
        steps = rng.uniform(0.02, 0.3, n) if k % 4 < 2 else np.full(n, rng.uniform(0.05, 0.15))
        t = rng.uniform(-3.0, 3.0) + np.cumsum(steps)
        shape = rng.uniform(0.4, 1.0, n) + np.linspace(*rng.uniform(0.0, 2.0, 2), n)
        along, less = rng.uniform(-1.0, 1.0), rng.uniform(0.6, 1.0)
        right, left = along + sign * shape, along - sign * less * shape
        turn = _R * np.trapezoid(right - left, t) / (2 * rng.uniform(0.3, 0.7))
        cases.append((t, left, right, float(turn)))
    return cases


def _sum_of(weight: Callable[[NDArray], object]) -> Callable[..., float]:
    """The half track from a sum, in which the samples have other weights than a trapezoid's."""
    return lambda t, left, right, turn: float(_R * np.sum((right - left) * weight(t)) / (2 * turn))


_UNEVEN = "one step for all samples: they are not even, and the first and last count half"

HALF_TRACK = Exercise(
    number="4.3",
    title="How wide does it act?",
    reference=effective_half_track,
    oracle="an_ideal_vehicle_of_that_half_track",
    cases=_records,
    mistakes={
        "that is an angle by an angle: the wheel's radius makes it a length": x_icr_27,
        "that is the whole effective track: half of it is asked": (
            lambda *spin: 2 * effective_half_track(*spin)
        ),
        "it is negative: right minus left, for a turn to the left": (
            lambda *spin: -effective_half_track(*spin)
        ),
        "a turn to the right is negative, and so is right minus left: keep the sign of both": (
            lambda t, left, right, turn: effective_half_track(t, left, right, abs(turn))
        ),
        "only the right side is used: the left wheels did not turn exactly as fast backwards": (
            lambda t, left, right, turn: effective_half_track(t, -right, right, turn)
        ),
        "only the left side is used: the right wheels did not turn exactly as fast": (
            lambda t, left, right, turn: effective_half_track(t, left, -left, turn)
        ),
        "left and right are added: what turns the vehicle is their difference": (
            lambda t, left, right, turn: effective_half_track(t, -left, right, turn)
        ),
        "a sum of speeds is no angle: each sample counts for its time step": _sum_of(lambda t: 1),
        _UNEVEN: _sum_of(lambda t: t[1] - t[0]),
        _UNEVEN + " (the mean step does not help)": _sum_of(lambda t: np.diff(t).mean()),
        _UNEVEN + " (nor does a mean speed)": _sum_of(lambda t: (t[-1] - t[0]) / len(t)),
        "the first and the last sample have half a step only: np.trapezoid": _sum_of(np.gradient),
        "each step runs with the speed at its begin: take the mean of both ends, np.trapezoid": (
            _sum_of(lambda t: np.append(np.diff(t), 0))
        ),
        "each step runs with the speed at its end: take the mean of both ends, np.trapezoid": (
            _sum_of(lambda t: np.append(0, np.diff(t)))
        ),
        "the times are not used: np.trapezoid(values, t)": (
            lambda t, *spin: effective_half_track(np.arange(len(t)), *spin)
        ),
        "/ 2 * turn multiplies by the turn: brackets round 2 turn": (
            lambda *spin: effective_half_track(*spin) * spin[3] ** 2
        ),
        "that is what it has more than the drawing: all of it is asked": (
            lambda *spin: effective_half_track(*spin) - _C
        ),
        "that takes the last speeds for all of the time: integrate them": (
            lambda t, left, right, turn: _R * (right - left)[-1] * (t[-1] - t[0]) / (2 * turn)
        ),
        "the turn is in radians already": (
            lambda *spin: effective_half_track(*spin[:3], np.degrees(spin[3]))
        ),
        "that takes the highest speeds for all of the time: integrate them": (
            lambda t, left, right, turn: _R * np.max(right - left) * (t[-1] - t[0]) / (2 * turn)
        ),
        "that is the half track of the drawing: the spins tell another one": lambda *spin: _C,
        "a larger wheel goes farther for the same angle: multiply by r": (
            lambda *spin: effective_half_track(*spin) / _R**2
        ),
    },
    hints=(
        "Each rim ran r times the angle of its wheel. Without slip, what would the turn have been?",
        "np.trapezoid(right - left, t) is an angle; times r, over twice the turn, it is a length.",
    ),
    tested_on="16 records to both sides, even and uneven, of half tracks from 0.3 to 0.7 m",
)
