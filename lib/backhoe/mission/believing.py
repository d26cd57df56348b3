"""The machine that knows where it is only by its sensors.

Encoders on the sprockets and a gyro, each with its noise, feed a student's odometry or filter, or
the library's; the tracker is told the pose that comes out. The truth is kept apart.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from backhoe.localisation.drives import NOISE
from backhoe.mission.asking import asked, checked_part, numbers

ESTIMATORS = ("odometry", "localisation")
LIBRARY = "library"
"""Instead of a part: the library's own."""


class Believing:
    """A plant whose pose is what its estimators say; everything else is the plant's own.

    Args:
        plant: on tracks, with `belts` [m/s] and `machine`.
        parts: "odometry", "localisation" or both, a part or LIBRARY each.
        fixes: time between two fixes of the position by a total station [s]; None for none.
        seed: of the sensors' noise.

    Attributes:
        truth: poses as they were, a list of (3,).
        beliefs: of each estimator, by its name, lists of (3,); the last estimator's count.

    Raises:
        ValueError: the plant has no belts.
    """

    def __init__(
        self, plant: object, parts: Mapping[str, object], fixes: float | None, seed: int
    ) -> None:
        if not hasattr(plant, "belts") or not hasattr(plant, "machine"):
            raise ValueError(
                f"{' and '.join(parts)} need encoders on tracks: drive the machine, not a "
                f"{type(plant).__name__}"
            )
        self._plant, self._fixes = plant, fixes
        self._radius = plant.machine.tracks.sprocket_radius
        self._rng = np.random.default_rng(seed)
        self._bias = NOISE.gyro_bias * self._rng.standard_normal()
        self._next_fix = plant.time if fixes is None else plant.time + fixes
        start = np.array(plant.pose)
        self._ask = estimators(parts, plant.machine, start)
        self.truth, self.beliefs = [start], {name: [start] for name in self._ask}

    def __getattr__(self, name: str) -> object:
        return getattr(self._plant, name)

    @property
    def pose(self) -> NDArray:
        """x, y, heading as believed, shape (3,) [m, m, rad]."""
        return list(self.beliefs.values())[-1][-1]

    def step(self, v: float, omega: float) -> None:
        """Drive for one sample, then look at the sensors; see `TrackedPlant.step`."""
        self._plant.step(v, omega)
        self.truth.append(np.array(self._plant.pose))
        left, right, gyro, fix = self._sensors()
        for name, ask in self._ask.items():
            self.beliefs[name].append(ask(self.beliefs[name][-1], left, right, gyro, fix, self.dt))

    def _sensors(self) -> tuple[float, float, float, NDArray | None]:
        noise = self._rng.standard_normal(5)
        rates = self._plant.belts / self._radius + sqrt(NOISE.encoder) * noise[:2]
        gyro = self._plant.twist[1] + self._bias + sqrt(NOISE.gyro) * noise[2]
        fix = None
        if self._fixes is not None and self._plant.time >= self._next_fix - self.dt / 2:
            from backhoe.localisation.fusion.fixes import STATION_STD

            self._next_fix += self._fixes
            fix = self.truth[-1][:2] + STATION_STD * noise[3:]
        return float(rates[0]), float(rates[1]), float(gyro), fix


def estimators(parts: Mapping[str, object], machine: object, start: NDArray) -> dict[str, Callable]:
    """Each part as ask(pose, left, right, gyro, fix, dt) -> pose (3,), set to the start.

    Args:
        parts: a part or LIBRARY by name; `localisation` comes last.
        machine: whose tracks they are.
        start: pose (3,) [m, m, rad].
    """
    from backhoe.localisation.fusion.online import Localiser, Odometer

    asks = {}
    for name in ESTIMATORS:
        part = parts.get(name)
        if part is None:
            continue
        own = isinstance(part, str)
        if own:
            part = Odometer(machine) if name == "odometry" else Localiser(machine)
        if name == "odometry":
            asks[name] = _reckoning(part, own)
        else:
            asks[name] = _localising(part, own, start)
    return asks


def checked_estimators(given: Mapping[str, object]) -> dict[str, object]:
    """The estimators that are given, each a callable or LIBRARY.

    Raises:
        TypeError: a part that cannot be called.
        ValueError: text that is not LIBRARY.
    """
    found = {name: part for name, part in given.items() if part is not None}
    for name, part in found.items():
        if not isinstance(part, str):
            checked_part(name, part)
        elif part != LIBRARY:
            raise ValueError(f"{name} must be a function or {LIBRARY!r}, got {part!r}")
    return found


def _reckoning(part: Callable, own: bool) -> Callable:
    if callable(getattr(part, "reset", None)):
        part.reset()

    def ask(pose: NDArray, left: float, right: float, gyro: float, fix: object, dt: float):
        if own:
            return part(pose, left, right, dt)
        answer = asked("odometry", part, pose, left, right, dt)
        return numbers("odometry", "your odometry", answer, (3,)).copy()

    return ask


def _localising(part: Callable, own: bool, start: NDArray) -> Callable:
    if callable(getattr(part, "reset", None)):
        part.reset(start.copy()) if own else asked("localisation", part.reset, start)

    def ask(pose: NDArray, left: float, right: float, gyro: float, fix: object, dt: float):
        if own:
            return part(left, right, gyro, fix, dt)
        answer = asked("localisation", part, left, right, gyro, fix, dt)
        return numbers("localisation", "your localisation", answer, (3,)).copy()

    return ask
