"""A drive of the machine itself: the simulated tracks slip on the ground as they will."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.localisation.drives.recording import NOISE, SEED, Noise, Recording, sense
from backhoe.localisation.drives.scenarios import Truth
from backhoe.mission.route import default_route
from backhoe.simulation.tracked_plant import TrackedPlant
from backhoe.vehicle.tracking import Path, PurePursuit, follow

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
    path = default_route() if path is None else path
    with TrackedPlant(backend=backend) as plant:
        watched = _Watched(plant)
        for _ in range(round(STANDING / plant.dt)):
            watched.step(0.0, 0.0)
        tracker = PurePursuit(lookahead=0.6)
        follow(tracker, watched, path, mode="trajectory", time_limit=time_limit)
        machine = plant.machine
    rows = np.array(watched.rows)
    belts = rows[:, 6:8] / machine.tracks.sprocket_radius
    motion = _motion(rows)
    return sense(
        "the machine on its tracks", motion, tuple(belts.T), np.nan, None, seed, noise, machine
    )


def _motion(rows: NDArray) -> Truth:
    time, pose, (v, omega), lateral = rows[:, 0], rows[:, 1:4], rows[:, 4:6].T, rows[:, 8]
    dt = time[1] - time[0]
    ahead = np.gradient(v, dt) - omega * lateral
    aside = np.gradient(lateral, dt) + omega * v
    return Truth(time, pose, v, omega, np.column_stack([ahead, aside]))


class _Watched:
    """The plant with a row kept of each sample: time, pose, twist, belts, lateral speed."""

    def __init__(self, plant: object) -> None:
        self._plant, self.dt, self.limits = plant, plant.dt, plant.limits
        self.rows = [self._row()]

    @property
    def pose(self) -> NDArray:
        return self._plant.pose

    @property
    def twist(self) -> NDArray:
        return self._plant.twist

    @property
    def time(self) -> float:
        return self._plant.time

    def step(self, v: float, omega: float) -> None:
        self._plant.step(v, omega)
        self.rows.append(self._row())

    def _row(self) -> list[float]:
        plant = self._plant
        return [plant.time, *plant.pose, *plant.twist, *plant.belts, plant.lateral_speed]
