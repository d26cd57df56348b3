"""From the angles of two encoders to poses.

Source: Mastalli 2013, Algorithm 1 corrected: with the sinc form of the arc it needs no threshold,
turns to the right are arcs as well, and one pose serves both branches.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import alike, numbers, positive
from backhoe.basics.se2 import twist_of_sides
from backhoe.localisation.odometry.dead_reckoning import integrate
from backhoe.machine import BACKHOE, Machine


@dataclass(frozen=True)
class Wheels:
    """What odometry has to know of a differential drive, each number in m.

    Attributes:
        left, right: effective radii of the wheels or sprockets [m].
        gauge: effective distance between the sides [m]; on tracks longer than the real one.

    Raises:
        ValueError: a length is not positive.
    """

    left: float
    right: float
    gauge: float

    def __post_init__(self) -> None:
        for name in ("left", "right", "gauge"):
            object.__setattr__(self, name, positive(getattr(self, name), f"Wheels.{name}", "m"))

    @classmethod
    def of(cls, machine: Machine = BACKHOE) -> Wheels:
        """The machine's own sprocket radius and gauge."""
        radius = machine.tracks.sprocket_radius
        return cls(radius, radius, machine.tracks.gauge)

    @property
    def ratio(self) -> float:
        """Radius right over radius left, E_d [1]."""
        return self.right / self.left

    @property
    def mean(self) -> float:
        """Mean radius [m]."""
        return (self.left + self.right) / 2

    def twist(self, left: ArrayLike, right: ArrayLike) -> tuple[NDArray, NDArray]:
        """v [m/s] and omega [rad/s] from wheel speeds [rad/s], or distance [m] and turn [rad] from
        wheel angles [rad], all of shape (...)."""
        left, right = self.left * numbers(left, "left"), self.right * numbers(right, "right")
        return twist_of_sides(left, right, self.gauge)


def from_angles(
    pose0: ArrayLike,
    left: ArrayLike,
    right: ArrayLike,
    wheels: Wheels | None = None,
    method: str = "exact",
) -> NDArray:
    """Poses from the angles that two encoders show: the odometry of a drive, in one call.

    Times are not needed: what counts is how far each side turned between readings.

    Args:
        pose0: x, y, psi at the first reading, shape (3,) or (..., 3) [m, m, rad].
        left, right: angles of the wheels, not wrapped, shape (..., N+1) [rad].
        wheels: radii and gauge; default those of the backhoe.
        method: one of `METHODS`.

    Returns:
        Shape (..., N+1, 3) [m, m, rad]; psi is not wrapped.

    Raises:
        ValueError: shapes that do not fit, a value that is not finite, an unknown method.
    """
    wheels = Wheels.of() if wheels is None else wheels
    left, right = numbers(left, "left", (..., "n")), numbers(right, "right", (..., "n"))
    alike(left=left, right=right)
    if left.shape[-1] < 2:
        raise ValueError(f"left and right must have 2 or more readings, got shape {left.shape}")
    distance, turn = wheels.twist(np.diff(left), np.diff(right))
    return integrate(pose0, distance, turn, 1.0, method)
