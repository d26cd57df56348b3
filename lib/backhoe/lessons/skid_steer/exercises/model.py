"""Exercise 4.4: the coefficients of the linear model with their dimensions repaired."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.vehicle.skid_steer import HUSKY, Vehicle, rates, replace

_RANGES = {
    "mass": (30, 90),
    "inertia": (1, 6),
    "wheel_radius": (0.08, 0.25),
    "half_track": (0.15, 0.5),
    "rolling": (0.01, 0.1),
    "lateral": (0.01, 0.3),
    "speed_gain": (2, 12),
}


def _vehicle(rng: np.random.Generator) -> Vehicle:
    axle = rng.uniform(0.15, 0.6)
    numbers = {name: rng.uniform(*span) for name, span in _RANGES.items()}
    return replace(HUSKY, front=axle, rear=axle, **numbers)


def _times(factors: Callable[[Vehicle], tuple]) -> Callable[[Vehicle], NDArray]:
    """The four rates, each multiplied by a factor that may depend on the vehicle."""
    return lambda vehicle: np.multiply(rates(vehicle), factors(vehicle))


RATES = Exercise(
    number="4.4",
    title="Repair a model by its units",
    reference=rates,
    oracle="four_wheels_pushed_and_dragged",
    cases=lambda rng: [(_vehicle(rng),) for _ in range(20)],
    mistakes={
        "that is the model as printed: neither its drives nor its turning drag are in 1/s": (
            _times(lambda p: (p.wheel_radius / 2, 1, p.wheel_radius / 2, p.half_track / p.front**2))
        ),
        "one r turns torque into force, another turns m/s into rad/s: divide by r^2": (
            _times(lambda p: (p.wheel_radius, 1, p.wheel_radius, 1))
        ),
        "each wheel has a motor: four of them push, not two": (_times(lambda p: (0.5, 1, 0.5, 1))),
        "the drives are repaired; the turning drag m g K_y c is still a force, not a torque": (
            _times(lambda p: (1, 1, 1, p.half_track / p.front**2))
        ),
        "the units fit, but sideways a wheel slips with a omega, and its lever is a: a^2": (
            _times(lambda p: (1, 1, 1, p.half_track**2 / p.front**2))
        ),
        "c enters the turn twice: once in the wheel's speed, once as the lever of its push": (
            _times(lambda p: (1, 1, 1 / p.half_track, 1))
        ),
        "a lever is a distance to the middle: a, not the whole wheelbase": (
            _times(lambda p: (1, 1, 1, 4))
        ),
        "that adds drive and drag for the drive: return the two parts": (
            lambda vehicle: np.dot(
                rates(vehicle), ((1, 0, 0, 0), (1, 1, 0, 0), (0, 0, 1, 0), (0, 0, 1, 1))
            )
        ),
        "one wheel does not push alone: four of them do": _times(lambda p: (0.25, 1, 0.25, 1)),
        "rates of decay are positive: drag brakes by its minus in the model": (
            _times(lambda p: (-1, -1, -1, -1))
        ),
        "the order is what drives and what drags v, then the same of omega": (
            lambda vehicle: np.array(rates(vehicle))[[0, 2, 1, 3]]
        ),
        "the r are right, but two wheels push, and the turning drag is still a force": (
            _times(lambda p: (0.5, 1, 0.5, p.half_track / p.front**2))
        ),
        "half the track is the lever of a push, not all of it": _times(lambda p: (1, 1, 4, 1)),
        "the slip has its a, the lever is missing: a force where a torque belongs": (
            _times(lambda p: (1, 1, 1, 1 / p.front))
        ),
        "a turn has a moment of inertia where the drive has a mass": (
            _times(lambda p: (1, 1, p.inertia / p.mass, p.inertia / p.mass))
        ),
        "these are forces and torques per speed: divide by the mass, and by the inertia": (
            _times(lambda p: (p.mass, p.mass, p.inertia, p.inertia))
        ),
        "all wheels together carry m g: each drags with a quarter of it, and there are four": (
            _times(lambda p: (1, 0.25, 1, 0.25))
        ),
        "the drives are right; the load on the wheels is m g, not m": (
            _times(lambda p: (1, 1 / p.gravity, 1, 1 / p.gravity))
        ),
        "rolling resistance and friction across are swapped: K_x along, K_y across": (
            _times(lambda p: (1, p.lateral / p.rolling, 1, p.rolling / p.lateral))
        ),
        "these are the Husky's own each time: use the vehicle that you are given": (
            lambda vehicle: rates(HUSKY)
        ),
        "that adds drive and drag, the rate of decay: return the two parts": (
            lambda vehicle: np.dot(
                rates(vehicle), ((1, 1, 0, 0), (0, 1, 0, 0), (0, 0, 1, 1), (0, 0, 0, 1))
            )
        ),
    },
    hints=(
        "tau = K (omega_ref - omega) at each wheel, omega = v / r, and its push is tau / r.",
        "Turning: each wheel slips sideways with a omega, drags with N K_y a omega, at a lever a.",
    ),
    tested_on="20 random vehicles with the centre of mass in the middle",
)
