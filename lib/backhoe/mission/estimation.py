"""The machine that knows where it is only by its sensors.

Encoders on the sprockets and a gyro, each with its noise, feed a student's odometry or filter, or
the library's; the tracker is told the pose that comes out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import deepcopy
from itertools import pairwise
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from backhoe.localisation.drives import NOISE
from backhoe.machine import Machine
from backhoe.mission.calls import call_part, reset

LONG = (15, 40, 25)
"""Samples that a long step of an odometry takes, in turn."""


class EstimatedPlant:
    """A plant whose pose is what its estimators say; everything else is the plant's own.

    Args:
        plant: on tracks, with `belts` [m/s] and `machine`.
        parts: "odometry", "localisation" or both in this order, a part or `calls.LIBRARY` each.
        fixes: time between two fixes of the position by a total station [s]; None for none.
        seed: of the sensors' noise.

    Attributes:
        estimates: poses by the estimator's name, lists of (3,) [m, m, rad]; the last estimator's
            count.
        claims: a list beside them with the covariance of the localisation's pose, (3, 3) each, NaN
            where it has no attribute `P` that begins with x, y and heading.
        surprises: NIS of each fix [1] by what the localisation claimed before it heard of it.
        rates: of the left and right sprocket in each sample, without noise, (2,) [rad/s].
    """

    def __init__(
        self, plant: object, parts: Mapping[str, Callable | str], fixes: float | None, seed: int
    ) -> None:
        self._plant, self._fixes = plant, fixes
        self._radius = plant.machine.tracks.sprocket_radius
        self._rng = np.random.default_rng(seed)
        self._bias = NOISE.gyro_bias * self._rng.standard_normal()
        self._next_fix = plant.time if fixes is None else plant.time + fixes
        start = np.array(plant.pose)
        self._parts = {name: _started(name, parts[name], plant.machine, start) for name in parts}
        self.estimates, self.rates = {name: [start] for name in parts}, []
        self.claims = [_claim(self._parts.get("localisation"))]
        self.surprises: list[float] = []

    def __getattr__(self, name: str) -> object:
        return getattr(self._plant, name)

    @property
    def pose(self) -> NDArray:
        """x, y, heading as estimated, shape (3,) [m, m, rad]."""
        return list(self.estimates.values())[-1][-1]

    def step(self, v: float, omega: float) -> None:
        """Drive for one sample, then read the sensors; see `TrackedPlant.step`."""
        self._plant.step(v, omega)
        self.sense()

    def sense(self) -> None:
        """Read the sensors at the end of a sample."""
        left, right, *others = self._sensors()
        if others[-1] is not None and np.isfinite(self.claims[-1]).all():
            self.surprises.append(self._surprise(left, right, *others))
        for name, part in self._parts.items():
            poses = self.estimates[name]
            seen = (poses[-1], left, right) if name == "odometry" else (left, right, *others)
            poses.append(call_part(name, part, *seen, self.dt, shape=(3,)))
        self.claims.append(_claim(self._parts.get("localisation")))

    def _surprise(self, left: float, right: float, yaw_rate: float, fix: NDArray) -> float:
        """NIS of a fix: a copy of the localisation that does not hear of it says where it is."""
        from backhoe.localisation.fusion.fixes import STATION_STD

        part = deepcopy(self._parts["localisation"])
        pose = call_part("localisation", part, left, right, yaw_rate, None, self.dt, shape=(3,))
        y, S = fix - pose[:2], _claim(part)[:2, :2] + STATION_STD**2 * np.eye(2)
        return float(y @ np.linalg.solve(S, y))

    def _sensors(self) -> tuple[float, float, float, NDArray | None]:
        """Rates of the left and right sprocket and of the gyro [rad/s], and a fix (2,) [m]."""
        noise = self._rng.standard_normal(5)
        self.rates.append(self._plant.belts / self._radius)
        rates = self.rates[-1] + sqrt(NOISE.encoder) * noise[:2]
        gyro = self._plant.twist[1] + self._bias + sqrt(NOISE.gyro) * noise[2]
        fix = None
        if self._fixes is not None and self._plant.time >= self._next_fix - self.dt / 2:
            from backhoe.localisation.fusion.fixes import STATION_STD

            self._next_fix += self._fixes
            fix = self._plant.pose[:2] + STATION_STD * noise[3:]
        return float(rates[0]), float(rates[1]), float(gyro), fix

    def in_long_steps(self) -> float:
        """How far the odometry's places move when it is asked seldom: root mean square [m].

        What the belts ran, without noise, is laid once more from the start: sample by sample, and
        in steps of `LONG` samples in turn. Arcs end at the same places both times.
        """
        start, part = self.estimates["odometry"][0], self._parts["odometry"]
        turned = np.vstack([np.zeros(2), np.cumsum(self.rates, axis=0)]) * self.dt
        turns = np.cumsum(np.tile(LONG, len(turned) // sum(LONG) + 1))
        edges = np.append(0, turns[turns < len(turned)])

        def laid(edges: NDArray) -> NDArray:
            poses = [start]
            for one, other in pairwise(edges.tolist()):
                dt = (other - one) * self.dt
                rates = ((turned[other] - turned[one]) / dt).tolist()
                poses.append(call_part("odometry", part, poses[-1], *rates, dt, shape=(3,)))
            return np.array(poses)

        apart = laid(np.arange(edges[-1] + 1))[edges] - laid(edges)
        return float(np.sqrt(np.mean(np.sum(apart[:, :2] ** 2, axis=1))))


def _started(name: str, part: Callable | str, machine: Machine, start: NDArray) -> Callable:
    """The part or, in place of LIBRARY, the library's; a localisation is told where it starts."""
    if isinstance(part, str):
        from backhoe.localisation.fusion.online import Localiser, Odometer

        part = Odometer(machine) if name == "odometry" else Localiser(machine)
    if name == "odometry":
        reset(part)
    elif callable(getattr(part, "reset", None)):
        call_part(name, part.reset, start)
    return part


def _claim(part: object) -> NDArray:
    """Covariance of the pose by a localisation's `P`, shape (3, 3); NaN where it has none."""
    try:
        P = np.array(getattr(part, "P", None), dtype=float)
    except (TypeError, ValueError):
        P = np.array(np.nan)
    usable = P.ndim == 2 and P.shape[0] == P.shape[1] >= 3
    return P[:3, :3] if usable else np.full((3, 3), np.nan)
