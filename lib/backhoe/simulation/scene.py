"""What stands around the machine: the ground's grid, spoil heaps, a bank and the dump truck.

Lengths in m, angles in rad, in the world frame (x forward, y left, z up; flat ground at z = 0).
All numbers are our choice, made so that the machine reaches heap and truck without driving.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import instance, number, numbers, positive, whole
from backhoe.basics.named import named, shown_by_name
from backhoe.machine import Machine
from backhoe.simulation.soil import Ground, Rock, SoilParameters, Terrain

ROUGHNESS = 0.03
"""Height of the bumps on a heap [m]; they come from the seed."""

FADING = 0.6
"""Over which a bank's surplus thins out [m]."""


@dataclass(frozen=True)
class Heap:
    """A rounded spoil heap: a cosine bump of `height` over a disc of `radius` [m]."""

    x: float
    y: float
    height: float
    radius: float

    def __post_init__(self) -> None:
        numbers((self.x, self.y, self.height), "Heap.x, y and height")
        positive(self.radius, "Heap.radius", "m")

    def height_at(self, x: NDArray, y: NDArray) -> NDArray:
        """Height above the flat ground at (x, y) [m], same shape as x and y."""
        distance = np.minimum(np.hypot(x - self.x, y - self.y) / self.radius, 1.0)
        return self.height / 2 * (1 + np.cos(np.pi * distance))


@dataclass(frozen=True)
class Bank:
    """A bank of earth, left higher than the slope that shall be cut from it.

    That slope rises from its foot, `foot` (x, y) its middle [m], in `direction` [rad], 1 m on
    `ratio` m of horizontal way, `length` up the slope [m]; behind its crest the bank is level. On
    it lies a `surplus` between two thicknesses [m], in bumps from the seed; it thins out over
    `FADING` at the foot and behind the crest. To both sides the bank goes on to the border.
    """

    foot: tuple[float, float]
    direction: float = 0.0
    ratio: float = 2.0
    length: float = 6.0
    surplus: tuple[float, float] = (0.10, 0.25)

    def __post_init__(self) -> None:
        numbers((*self.foot, self.direction), "Bank.foot and direction", (3,))
        for name in ("ratio", "length"):
            positive(getattr(self, name), f"Bank.{name}", "m")
        least, most = numbers(self.surplus, "Bank.surplus", (2,), meaning="from, to [m]")
        if not 0 <= least <= most:
            raise ValueError(f"Bank.surplus must rise from 0 or more, got {self.surplus}")

    def heights_at(self, x: NDArray, y: NDArray, rng: np.random.Generator) -> NDArray:
        """Heights at (x, y) [m], same shape as x and y; rng makes the bumps."""
        c, s = np.cos(self.direction), np.sin(self.direction)
        along = (x - self.foot[0]) * c + (y - self.foot[1]) * s
        run = self.length * self.ratio / np.hypot(1.0, self.ratio)
        on = np.clip(along / FADING, 0, 1) * np.clip((run + 2 * FADING - along) / FADING, 0, 1)
        least, most = self.surplus
        bumps = _bumps(x, y, rng) / ROUGHNESS
        return np.clip(along, 0, run) / self.ratio + on * (least + (most - least) * bumps)


@dataclass(frozen=True)
class Truck:
    """A dump truck that stands with its nose along x, the middle of its bed at (x, y).

    The open bed is `bed_length` along x by `bed_width` inside, its `floor` and the top of its
    `wall` measured from the ground [m].
    """

    x: float
    y: float
    bed_length: float
    bed_width: float
    floor: float
    wall: float

    def __post_init__(self) -> None:
        numbers((self.x, self.y), "Truck.x and y")
        for name in ("bed_length", "bed_width", "floor"):
            positive(getattr(self, name), f"Truck.{name}", "m")
        number(self.wall, "Truck.wall", "m", above=self.floor)


@shown_by_name
@dataclass(frozen=True)
class Scene:
    """A grid of `rows` x `columns` heights (y by x), `cell` [m] apart, with what lies on it.

    `corner` is the (x, y) of the first height [m]; `rocks` lie fixed in the ground, and where one
    sticks out of it the ground's surface is the rock's.
    """

    corner: tuple[float, float]
    rows: int
    columns: int
    cell: float
    heaps: tuple[Heap, ...] = ()
    truck: Truck | None = None
    bank: Bank | None = None
    rocks: tuple[Rock, ...] = ()

    def __post_init__(self) -> None:
        for rock in self.rocks:
            instance(rock, "each of Scene.rocks", Rock)
        whole(self.rows, "Scene.rows", least=2)
        whole(self.columns, "Scene.columns", least=2)
        positive(self.cell, "Scene.cell", "m")

    def grid(self) -> tuple[NDArray, NDArray]:
        """World x and y of every height, each of shape (rows, columns) [m]."""
        x = self.corner[0] + self.cell * np.arange(self.columns)
        y = self.corner[1] + self.cell * np.arange(self.rows)
        return tuple(np.meshgrid(x, y))

    def heights(self, seed: int = 0) -> NDArray:
        """Heights of the untouched ground, shape (rows, columns) [m]; bumps from the seed."""
        x, y = self.grid()
        ground = np.zeros(x.shape)
        for heap in self.heaps:
            ground += heap.height_at(x, y)
        if ground.any():
            covered = np.minimum(ground / ground.max() * 4, 1.0)
            ground += covered * _bumps(x, y, np.random.default_rng(seed))
        if self.bank is not None:
            ground += self.bank.heights_at(x, y, np.random.default_rng(seed))
        return ground


def untouched_ground(
    scene: Scene, machine: Machine, seed: int, hold: float, soil: SoilParameters
) -> Ground:
    """The soil of a scene before anyone dug in it.

    Args:
        scene: what stands around the machine.
        machine: whose bucket digs.
        seed: of the bumps on the heaps.
        hold: time over which the bucket feels one force of the soil [s].
        soil: its strength and weight.
    """
    heights, floor = scene.heights(seed), None
    if scene.rocks:
        floor = np.max([rock.top_at(*scene.grid()) for rock in scene.rocks], axis=0)
        heights = np.maximum(heights, floor)
    terrain = Terrain(heights, scene.cell, scene.corner, floor)
    truck, bed = scene.truck, None
    if truck is not None:
        bed = Terrain.bed(
            (truck.x, truck.y),
            truck.bed_length,
            truck.bed_width,
            truck.floor,
            truck.wall,
            scene.cell,
        )
    return Ground(terrain, bed, soil, machine, scene.rocks, hold=hold)


def _bumps(x: NDArray, y: NDArray, rng: np.random.Generator) -> NDArray:
    waves = np.zeros_like(x)
    for _ in range(8):
        direction, phase = rng.uniform(0, 2 * np.pi, 2)
        wavelength = rng.uniform(0.6, 1.6)
        along = np.cos(direction) * x + np.sin(direction) * y
        waves += np.sin(2 * np.pi * along / wavelength + phase)
    return ROUGHNESS / 2 * (1 + waves / 8)


LOADING = named(
    "LOADING",
    Scene(
        corner=(-3.0, -6.4),
        rows=175,
        columns=161,
        cell=0.08,
        heaps=(Heap(x=6.0, y=0.0, height=1.0, radius=2.5),),
        truck=Truck(x=0.8, y=5.3, bed_length=4.4, bed_width=2.4, floor=1.1, wall=1.9),
    ),
)
"""A spoil heap ahead and a truck on the left: what the tour digs and fills."""

FLAT = named("FLAT", Scene(corner=(-8.0, -8.0), rows=101, columns=101, cell=0.16))
"""Nothing but flat ground."""

GRADING = named(
    "GRADING",
    Scene(corner=(-3.0, -7.2), rows=181, columns=213, cell=0.08, bank=Bank(foot=(5.0, 0.0))),
)
"""A bank ahead, to be cut to a slope of 1:2, 6 m long; its foot is across the machine's way."""

TRENCHING = named("TRENCHING", Scene(corner=(-6.0, -6.8), rows=171, columns=213, cell=0.08))
"""Level ground to dig a trench in."""
