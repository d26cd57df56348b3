"""A drive of the machine itself: the simulated tracks slip on the ground as they will."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.localisation.drives.recording import NOISE, SEED, Noise, Recording, sense
from backhoe.localisation.drives.scenarios import Truth
from backhoe.mission.driving import Watched, drive
from backhoe.simulation.tracked_plant import TrackedPlant
from backhoe.vehicle.tracking import Path

STANDING = 3.0
"""Before it sets off, as in the other drives [s]."""


def drive_the_machine(
    path: Path | None = None,
    *,
    seed: int = SEED,
    noise: Noise = NOISE,
    backend: str = "analytic",
    time_limit: float | None = None,
) -> Recording:
    """Drive the machine along a path in the simulation and record encoders and IMU at 50 Hz.

    Args:
        path: with times; default that of `mission.drive`, a G of about a minute.
        seed: of the noise, 0 or more.
        noise: variances of a sample and bias.
        backend: as in `simulation.open_world`; "analytic" repeats bit for bit.
        time_limit: end of the drive at the latest [s].

    Returns:
        Sensors and truth; how much the tracks slip is not known (`turning` is NaN).

    Raises:
        ValueError: a path without times, or an unknown backend.
    """
    with TrackedPlant(backend=backend) as plant:
        watched = Watched(plant, _row)
        for _ in range(round(STANDING / plant.dt)):
            watched.step(0.0, 0.0)
        drive(plant=watched, path=path, mode="trajectory", time_limit=time_limit)
        machine = plant.machine
    rows = np.array(watched.seen)
    belts = rows[:, 6:8] / machine.tracks.sprocket_radius
    motion = _motion(rows)
    return sense(
        "the machine on its tracks", motion, tuple(belts.T), seed=seed, noise=noise, machine=machine
    )


def _row(plant: TrackedPlant) -> tuple[float, ...]:
    """Time, pose, twist, belts and lateral speed [s, m, rad, m/s, rad/s]."""
    return plant.time, *plant.pose, *plant.twist, *plant.belts, plant.lateral_speed


def _motion(rows: NDArray) -> Truth:
    time, pose, (v, omega), lateral = rows[:, 0], rows[:, 1:4], rows[:, 4:6].T, rows[:, 8]
    dt = time[1] - time[0]
    ahead = np.gradient(v, dt) - omega * lateral
    aside = np.gradient(lateral, dt) + omega * v
    return Truth(time, pose, v, omega, np.column_stack([ahead, aside]))
