"""Exercise 4.4: the coefficients of the linear model with their dimensions repaired."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.vehicle.skid_steer import HUSKY, Vehicle, replace


def rates(vehicle: Vehicle) -> NDArray:
    """Drive and drag of v, drive and drag of omega in (2.15) repaired, shape (4,) [1/s]."""
    m, inertia = vehicle.mass, vehicle.inertia
    r, c = vehicle.wheel_radius, vehicle.half_track
    push = 4 * vehicle.speed_gain / r**2
    drag_v = vehicle.gravity * vehicle.rolling
    drag_omega = m * vehicle.gravity * vehicle.lateral * vehicle.front**2 / inertia
    return np.array([push / m, drag_v, push * c**2 / inertia, drag_omega])


def _vehicles(rng: np.random.Generator) -> list[tuple]:
    vehicles = []
    for _ in range(20):
        axle = rng.uniform(0.15, 0.6)
        numbers = {
            "mass": rng.uniform(30, 90),
            "inertia": rng.uniform(1, 6),
            "wheel_radius": rng.uniform(0.08, 0.25),
            "half_track": rng.uniform(0.15, 0.5),
            "rolling": rng.uniform(0.01, 0.1),
            "lateral": rng.uniform(0.01, 0.3),
            "speed_gain": rng.uniform(2, 12),
        }
        vehicles.append((replace(HUSKY, front=axle, rear=axle, **numbers),))
    return vehicles


def _drive(vehicle: Vehicle, factor: float) -> NDArray:
    return rates(vehicle) * (factor, 1, factor, 1)


def _turning_drag(vehicle: Vehicle, lever: float) -> NDArray:
    return rates(vehicle) * (1, 1, 1, lever / vehicle.front**2)


RATES = Exercise(
    number="4.4",
    title="Repair (2.15)",
    reference=rates,
    cases=_vehicles,
    mistakes={
        "that is (2.15) as printed: neither its drives nor its turning drag are in 1/s": (
            lambda vehicle: (
                _drive(vehicle, vehicle.wheel_radius / 2)
                * (1, 1, 1, vehicle.half_track / vehicle.front**2)
            )
        ),
        "one r turns torque into force, another turns m/s into rad/s: divide by r^2": (
            lambda vehicle: _drive(vehicle, vehicle.wheel_radius)
        ),
        "hypothesis 7 gives each wheel its torque: four of them push, not two": (
            lambda vehicle: _drive(vehicle, 0.5)
        ),
        "the drives are repaired; the turning drag m g K_y c is still a force, not a torque": (
            lambda vehicle: _turning_drag(vehicle, vehicle.half_track)
        ),
        "the units fit, but sideways a wheel slips with a omega, and its lever is a: a^2": (
            lambda vehicle: _turning_drag(vehicle, vehicle.half_track**2)
        ),
        "c enters the turn twice: once in the wheel's speed, once as the lever of its push": (
            lambda vehicle: rates(vehicle) * (1, 1, 1 / vehicle.half_track, 1)
        ),
        "these are the Husky's own each time: use the vehicle that you are given": (
            lambda vehicle: rates(HUSKY)
        ),
        "that adds drive and drag, the rate of decay: return the two parts": (
            lambda vehicle: (
                rates(vehicle) @ ((1, 1, 0, 0), (0, 1, 0, 0), (0, 0, 1, 1), (0, 0, 0, 1))
            )
        ),
    },
    hints=(
        "tau = K (omega_ref - omega) at each wheel, omega = v / r, and its push is tau / r.",
        "Turning: each wheel slips sideways with a omega, drags with N K_y a omega, at a lever a.",
    ),
    tested_on="20 random vehicles with the centre of mass in the middle",
)
