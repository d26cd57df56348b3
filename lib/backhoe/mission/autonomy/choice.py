"""Where to dig: strips of the ground, what each is expected to bring, and the one that pays best.

The ground comes as the machine sees it from its swing axis: rows are directions, columns are
reaches. A strip is one stroke of the bucket straight towards the machine. It is the hand-made
stroke of `mission.parts`, turned, moved out or in, and raised or lowered.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from math import cos, pi, radians, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics import forward_kinematics, inverse_kinematics
from backhoe.basics import inputs
from backhoe.machine import BACKHOE
from backhoe.mission.parts import CUTTING, STROKE, TIPPING, smooth_trajectory

DIRECTIONS = np.radians(np.arange(-75.0, 61.0, 3.0))
"""Rows of the machine's view [rad] from straight ahead; the truck stands to the left."""

REACHES = np.arange(30, 81) / 10
"""Columns of the machine's view [m] from the swing axis."""

LEVEL = 0.05
"""The edge keeps this far above the ground that the machine stands on [m]."""

FULL = 0.7
"""In a bucket that has been lifted [m^3]; more is counted on by nobody."""

LOST = 0.3
"""Of the way from the start [m]: what is cut there is pushed aside, what is cut later ends up in
the bucket. Over 400 digs at random in sandy loam the fill is foreseen so to 0.05 m^3."""

TIMES = np.cumsum([0.0, *(seconds for _, seconds, *_ in STROKE[1:])])
"""Of the way-points of a stroke, from the first on [s]."""

EMPTYING = sum(seconds for _, seconds, _ in TIPPING[1:])
"""[s]"""

SWING_RATE = (pi / 2) / TIPPING[0][1]
"""Mean speed of a swing [rad/s]."""

STARTS = np.arange(52, 64) / 10
DEPTHS = (0.15, 0.3, 0.45, 0.6)
"""What the reference tries [m]."""

LEAST = 0.1
"""A bucket that would bring less is not worth the time [m^3]."""

MOST_SIDE_LOAD = BACKHOE.swing.joint.torque / 4
"""Torque about the swing axis that soil deeper on one side of the bucket may give [N m]."""

SIDE_PRESSURE = (1 - sin(radians(33))) * 1600 * BACKHOE.gravity
"""Of sandy loam at rest, a metre deep [Pa/m]."""


class Strip(NamedTuple):
    """One stroke: `direction` from straight ahead, to the left [rad]; `start` of the edge in the
    soil, from the swing axis [m]; `depth` below the surface there [m]."""

    direction: float
    start: float
    depth: float


def polar(
    terrain: object,
    pose: ArrayLike = (0.0, 0.0, 0.0),
    directions: ArrayLike | None = None,
    reaches: ArrayLike | None = None,
) -> tuple[NDArray, NDArray]:
    """A map as it lies around the machine.

    Args:
        terrain: heights [m] with their `grid()`, and `variance` [m^2] if it has one: a
            `perception.terrain_map.TerrainMap`, or the true `simulation.soil.Terrain`.
        pose: x, y, heading of the machine in the map [m, rad].
        directions: (n,) [rad]; default `DIRECTIONS`.
        reaches: (m,) [m]; default `REACHES`.

    Returns:
        Heights and their standard deviations, each (n, m) [m], between the cells in proportion;
        NaN where one of the four cells around has not been seen, or off the map.

    Raises:
        ValueError: another shape, or not finite.
    """
    from scipy.ndimage import map_coordinates

    directions = DIRECTIONS if directions is None else directions
    reaches = REACHES if reaches is None else reaches
    directions = inputs.numbers(directions, "directions", ("n",), meaning="angles [rad]")
    reaches = inputs.numbers(reaches, "reaches", ("m",), meaning="distances [m]")
    x, y, heading = inputs.numbers(pose, "pose", (3,), meaning="x, y, heading [m, rad]")
    grid_x, grid_y = terrain.grid()
    turn = heading + directions[:, None]
    axis = x + BACKHOE.base.offset * cos(heading), y + BACKHOE.base.offset * sin(heading)
    cell = grid_x[0, 1] - grid_x[0, 0]
    row = (axis[1] + reaches * np.sin(turn) - grid_y[0, 0]) / cell
    column = (axis[0] + reaches * np.cos(turn) - grid_x[0, 0]) / cell
    variance = getattr(terrain, "variance", np.zeros_like(terrain.heights))
    layers = terrain.heights, np.sqrt(variance)
    at = np.stack([row, column])
    heights, deviation = (map_coordinates(one, at, order=1, cval=np.nan) for one in layers)
    return heights, deviation


@lru_cache(maxsize=1)
def edge() -> tuple[NDArray, NDArray]:
    """The lowest way of the bucket's edge in a stroke, seen from its start.

    Returns:
        Way outwards from the start, rising, and height above it, (n,) each [m].
    """
    q_way = inverse_kinematics(_moved(0.0, 0.0, 0.0))
    q, _ = smooth_trajectory(TIMES, q_way, np.linspace(0.0, TIMES[-1], 400))
    r, _, z = forward_kinematics(q)[:, :3, 3].T
    start = forward_kinematics(q_way[1])[:3, 3]
    out = np.arange(-20, 11) / 10
    near = np.abs(r - start[0] - out[:, None]) < 0.06
    low = np.where(near, z - start[2], np.inf).min(axis=1)
    seen = np.isfinite(low)
    return out[seen], low[seen]


def cut_depth(
    strip: Strip, heights: NDArray, directions: NDArray, reaches: NDArray, aside: float = 0.0
) -> NDArray:
    """How deep the edge passes below the surface of a strip, at each of the reaches.

    Args:
        strip: the stroke.
        heights: (n, m) [m]; unseen ground, NaN, counts as none.
        directions: (n,), evenly spaced [rad].
        reaches: (m,) [m].
        aside: of the strip's middle, to the left [m].

    Returns:
        (m,) [m]; 0 where the edge is above the surface. For starts and depths of shape (k,) it is
        (k, m), here and below.

    Raises:
        ValueError: shapes, or directions or reaches that do not rise.
    """
    heights, directions, reaches = _ground(heights, directions, reaches)
    at = (strip.direction + aside / reaches - directions[0]) / (directions[1] - directions[0])
    row = np.clip(np.floor(at).astype(int), 0, len(directions) - 2)
    part, column = np.clip(at - row, 0.0, 1.0), np.arange(len(reaches))
    surface = (1 - part) * heights[row, column] + part * heights[row + 1, column]
    out, low = edge()
    way = reaches - np.asarray(strip.start)[..., None]
    bottom = edge_height(strip, heights, directions, reaches)[..., None]
    bottom = bottom + np.interp(way, out, low, left=np.inf, right=np.inf)
    return np.clip(np.nan_to_num(surface) - bottom, 0.0, None)


def edge_height(strip: Strip, heights: NDArray, directions: NDArray, reaches: NDArray) -> float:
    """Of the bucket's edge at the start of a strip [m]: its depth below the surface, but so high
    that the edge keeps `LEVEL` above the machine's ground all the way. Arguments as `cut_depth`.
    """
    heights, directions, reaches = _ground(heights, directions, reaches)
    i = int(np.argmin(np.abs(directions - strip.direction)))
    surface = np.interp(strip.start, reaches, np.nan_to_num(heights[i]))
    return np.maximum(surface - strip.depth, LEVEL - edge()[1].min())


def expected_fill(strip: Strip, heights: NDArray, directions: NDArray, reaches: NDArray) -> float:
    """Soil that a strip is expected to leave in the bucket [m^3]; arguments as `cut_depth`."""
    half = BACKHOE.shell.width / 2
    depth = np.mean(
        [
            cut_depth(strip, heights, directions, reaches, side * half)
            for side in (-2 / 3, 0, 2 / 3)
        ],
        axis=0,
    )
    return bucket_fill(depth, reaches, strip.start)


def bucket_fill(depth: NDArray, reaches: NDArray, start: float) -> float:
    """Soil that a cut leaves in the bucket: all but that of the first `LOST` metres, up to `FULL`.

    Args:
        depth: of the cut below the surface at each of the reaches, shape (m,) [m].
        reaches: evenly spaced, shape (m,) [m].
        start: where the edge enters; it comes nearer from there [m].

    Returns:
        Volume [m^3]; for depth (k, m) and start (k,) shape (k,).
    """
    kept = reaches <= np.asarray(start)[..., None] - LOST + 1e-9
    volume = BACKHOE.shell.width * (reaches[1] - reaches[0]) * np.sum(kept * depth, axis=-1)
    return np.minimum(volume, FULL)


def side_load(strip: Strip, heights: NDArray, directions: NDArray, reaches: NDArray) -> float:
    """Torque about the swing axis by which soil deeper on the left pushes to the right [N m].

    Earth pressure at rest grows with depth, so a side under a depth d of soil gets K d^2 / 2 a
    metre of way. Arguments as `cut_depth`.
    """
    half = BACKHOE.shell.width / 2
    left, right = (cut_depth(strip, heights, directions, reaches, side) for side in (half, -half))
    step = reaches[1] - reaches[0]
    return SIDE_PRESSURE / 2 * step * np.sum(reaches * (left**2 - right**2), axis=-1)


def cycle_time(direction: float, truck: float = pi / 2) -> float:
    """From bucket to bucket: digging, emptying, and two swings between strip and truck [s].

    Args:
        direction, truck: directions of both from straight ahead [rad].
    """
    swing = abs(inputs.number(truck, "truck", "rad") - inputs.number(direction, "direction", "rad"))
    return float(TIMES[-1]) + EMPTYING + 2 * swing / SWING_RATE


def best_strip(
    heights: NDArray,
    deviation: NDArray,
    directions: NDArray,
    reaches: NDArray,
    truck: float = pi / 2,
) -> Strip | None:
    """The strip that is expected to bring most soil a second.

    It counts on what is surely there, a standard deviation below the map, and leaves strips alone
    that push the bucket aside by more than `MOST_SIDE_LOAD`.

    Args:
        heights, deviation: (n, m) [m]; NaN where nothing has been seen.
        directions: (n,), evenly spaced [rad].
        reaches: (m,) [m] from the swing axis.
        truck: its direction [rad].

    Returns:
        The strip, or None where none would bring `LEAST`.
    """
    heights, directions, reaches = _ground(heights, directions, reaches)
    deviation = inputs.numbers(deviation, "deviation", heights.shape, finite=False)
    ground = heights - deviation, directions, reaches
    starts, depths = map(np.ravel, np.meshgrid(STARTS, DEPTHS, indexing="ij"))
    strips = [Strip(direction, starts, depths) for direction in directions]
    fill, side = (
        np.array([judge(strip, *ground) for strip in strips])
        for judge in (expected_fill, side_load)
    )
    found = best_of(fill, side, directions, truck)
    if found is None:
        return None
    i, k = found
    return Strip(float(directions[i]), float(starts[k]), float(depths[k]))


def best_of(
    fill: NDArray, side: NDArray, directions: NDArray, truck: float = pi / 2
) -> tuple[int, int] | None:
    """Which of some strips brings most soil a second and does not push the bucket aside too much.

    Args:
        fill: expected of strips in n directions, k in each, shape (n, k) [m^3].
        side: their side loads, shape (n, k) [N m].
        directions: shape (n,) [rad].
        truck: its direction [rad].

    Returns:
        Row and column, or None where no strip that may be dug brings `LEAST`.
    """
    may = (np.abs(side) <= MOST_SIDE_LOAD) & (fill >= LEAST)
    times = np.array([cycle_time(float(direction), truck) for direction in directions])
    rate = np.where(may, fill / times[:, None], 0.0)
    i, k = np.unravel_index(int(rate.argmax()), rate.shape)
    return (int(i), int(k)) if may[i, k] else None


def highest_strip(
    heights: NDArray,
    deviation: NDArray,
    directions: NDArray,
    reaches: NDArray,
    truck: float = pi / 2,
) -> Strip | None:
    """The greedy rival: a strip that starts at the highest point in reach.

    Args:
        heights, deviation: (n, m) [m]; NaN where nothing has been seen.
        directions: (n,) [rad].
        reaches: (m,) [m].

    Returns:
        The strip, 0.45 m deep, or None where all is bare.
    """
    heights, directions, reaches = _ground(heights, directions, reaches)
    can = np.where(np.isin(np.round(reaches, 6), np.round(STARTS, 6)), heights, np.nan)
    if not np.nanmax(can, initial=0.0) > LEVEL:
        return None
    i, j = np.unravel_index(np.nanargmax(can), can.shape)
    return Strip(float(directions[i]), float(reaches[j]), DEPTHS[2])


def random_strip(seed: int = 0) -> Callable[..., Strip | None]:
    """A rival that takes any place where there is soil, at random. It is called as `best_strip`."""
    rng = np.random.default_rng(inputs.whole(seed, "seed", least=0))

    def dig_choice(heights, deviation, directions, reaches):
        can = np.isin(np.round(reaches, 6), np.round(STARTS, 6)) & (heights > 2 * LEVEL)
        if not can.any():
            return None
        i, j = rng.choice(np.argwhere(can))
        return Strip(float(directions[i]), float(reaches[j]), DEPTHS[2])

    return dig_choice


def stroke(
    strip: Strip, heights: NDArray, directions: NDArray, reaches: NDArray
) -> tuple[NDArray, NDArray]:
    """The way of a strip: from above it, in, along, curled and lifted; arguments as `cut_depth`.

    Returns:
        Times from the start on, (5,) [s]; x, y, z of the stick's tip [m] and the bucket joint's
        angle [rad] then, (5, 4).

    Raises:
        ValueError: the strip is out of the arm's reach, or not three finite numbers.
    """
    strip = Strip(*inputs.numbers(strip, "strip", (3,), meaning="direction, start, depth").tolist())
    start = forward_kinematics(inverse_kinematics(_moved(0.0, 0.0, 0.0)[1]))[:3, 3]
    out = strip.start - (start[0] - BACKHOE.base.offset)
    up = edge_height(strip, heights, directions, reaches) - start[2]
    return TIMES.copy(), _moved(strip.direction, out, float(up))


def _ground(
    heights: NDArray, directions: NDArray, reaches: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    """Heights (n, m) with their directions (n,) and reaches (m,), n and m at least 2."""
    heights = inputs.numbers(heights, "heights", ("n", "m"), finite=False)
    directions = inputs.times(directions, "directions")
    reaches = inputs.times(reaches, "reaches")
    inputs.numbers(heights, "heights", (len(directions), len(reaches)), finite=False)
    return heights, directions, reaches


def _moved(direction: float, out: float, up: float) -> NDArray:
    """The hand-made stroke elsewhere, its bucket at the same slope to the ground, (5, 4)."""
    path = []
    for name, _, r, z, bucket in STROKE:
        there = r + out * (name != "lift"), z + up * (name in CUTTING)
        q, q_there = (_posture(*place, radians(bucket)) for place in ((r, z), there))
        bucket = radians(bucket) + float(q[1:3].sum() - q_there[1:3].sum())
        x = BACKHOE.base.offset + there[0] * cos(direction)
        path.append((x, there[0] * sin(direction), there[1], bucket))
    return np.array(path)


def _posture(reach: float, height: float, bucket: float) -> NDArray:
    return inverse_kinematics(np.array((BACKHOE.base.offset + reach, 0.0, height, bucket)))
