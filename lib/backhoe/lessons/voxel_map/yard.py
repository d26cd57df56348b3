"""The yard of lesson 09b: heap and truck, scanned from the place of the left laser.

One fan of rays a scan, from one place: as if all of it were seen at once. Each scan is shifted by a
random part of a step, as lines of a nodding laser are.
Points on the machine itself are left out, by what the simulation knows of them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe import simulation
from backhoe.basics.inputs import instance, numbers, positive
from backhoe.machine.sensors import LASERS
from backhoe.perception.octree import OccupancyOctree
from backhoe.simulation.scanning import pose_now
from backhoe.simulation.sight import Sight

__all__ = ["FAR", "Yard", "occupied"]

FAR = 99.0
"""Length given to rays that nothing reflects [m]."""

_MACHINE = ("undercarriage", "swing", "boom", "stick", "bucket")


class Yard:
    """The loading scene, with its truck or without, and a laser that looks ahead and to the left.

    Attributes:
        laser: where its rays begin, shape (3,) [m].

    Args:
        truck: whether it is there.
        seed: of the noise of the ranges.
    """

    def __init__(self, truck: bool = True, seed: int = 9) -> None:
        scene = simulation.LOADING if truck else replace(simulation.LOADING, truck=None)
        world = simulation.open_world(backend="analytic", scene=scene)
        self.laser = pose_now(world, LASERS["left"].mount)[:3, 3]
        self._sight, self._rng = Sight(world), np.random.default_rng(seed)
        self._own = [self._sight.names.index(name) for name in _MACHINE]

    def scan(self, step: float = 0.5) -> NDArray:
        """Where the rays of one scan end, shape (n, 3) [m]; `FAR` away where nothing comes back.

        Args:
            step: angle between neighbouring rays [deg].

        Raises:
            ValueError: a step that is not above 0.
        """
        step = positive(step, "step", "deg")
        turn, rise = np.meshgrid(np.arange(-50, 120, step), np.arange(-60, 3, step))
        shift = self._rng.uniform(0, step, 2)
        turn, rise = np.radians((turn.ravel() + shift[0], rise.ravel() + shift[1]))
        rays = np.stack([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)])
        hits = self._sight.cast(np.tile(self.laser, (turn.size, 1)), rays.T)
        noise = LASERS["left"].noise * self._rng.standard_normal(turn.size)
        length = np.where(np.isfinite(hits.t), hits.t + noise, FAR)
        points = self.laser + length[:, None] * rays.T
        return points[~np.isin(hits.surface, self._own)]


def occupied(tree: OccupancyOctree, edge: float, box: ArrayLike, policy: str = "max") -> NDArray:
    """Middles of the occupied voxels of one size in a box, shape (n, 3) [m].

    Args:
        tree: the map.
        edge: of the voxels, the map's resolution doubled as often as you like [m].
        box: lowest and highest corner, shape (2, 3) [m].
        policy: as for `OccupancyOctree.log_odds`.

    Raises:
        ValueError: an edge that is no such multiple, or a box of another shape.
        TypeError: tree is no map.
    """
    levels = np.log2(
        positive(edge, "edge", "m") / instance(tree, "tree", OccupancyOctree).resolution
    )
    if levels < -1e-9 or abs(levels - round(levels)) > 1e-9:
        raise ValueError(f"edge must be {tree.resolution} m doubled 0, 1, 2, ... times, got {edge}")
    sides = numbers(box, "box", (2, 3), meaning="corners x, y, z [m]").T / edge
    axes = [np.arange(np.floor(low), np.ceil(high)) + 0.5 for low, high in sides]
    middles = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3) * edge
    return middles[tree.log_odds(middles, 16 - round(levels), policy) >= 0]
