"""What the machine makes of its lasers: heights of the ground, and where the truck stands."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import short, truths
from backhoe.machine import JOINTS
from backhoe.mission.autonomy.body import Body, Halt
from backhoe.mission.calls import call_part
from backhoe.mission.worksite import EYES, SWEEP
from backhoe.perception.cloud import self_filter, shadow_filter
from backhoe.perception.laser import Motion, deskew, sensor_poses
from backhoe.perception.terrain_map import TerrainMap, is_soil
from backhoe.simulation.scanning import Scanner
from backhoe.simulation.scene import Truck
from backhoe.simulation.volumes import link_volumes
from backhoe.view.appearance import truck_visuals

AREA = (-9.0, -9.0), 190, 210, 0.1
"""Of the map: corner (x, y) [m], rows, columns, cell [m]."""

FEW = 500
"""A look with fewer points than this is lost."""

TRIES = 3
"""So many lost looks after another end the mission."""

STALE = 2.0
"""What is older is not looked at any more: the machine looks again [s]."""

ABOVE = 0.3
"""What is no soil and not lower is a thing [m]."""

NEAR, ENOUGH = 0.12, 0.75
"""The truck is found if so large a share of what is no soil lies so near to it [m, 1]."""

GAP = 0.5
"""Between lines of the lasers the ground is filled in over so much [m]."""

FEWEST = 150
"""Points that a truck must have."""


class Found(NamedTuple):
    """Where the truck stands: the middle of its bed x, y [m], the share of the points that fit it,
    and their number."""

    x: float
    y: float
    share: float
    points: int


@dataclass(frozen=True, eq=False)
class View:
    """What was seen at a look, and what was true.

    Attributes:
        event, time: what it was for, and when it began [s].
        belief, pose: where the machine took itself to be, and where it was, (3,) [m, m, rad].
        q: joint angles, (4,) [rad].
        points: on soil and on other things, in the believed world, shape (n, 3) each [m].
        heights: of the map afterwards, NaN where unknown, and of the true ground, each with its own
            grid, shape (rows, columns) [m].
        truck: found or None; `there`: whether it was there.
    """

    event: str
    time: float
    belief: NDArray
    pose: NDArray
    q: NDArray
    points: tuple[NDArray, NDArray]
    heights: tuple[NDArray, NDArray]
    truck: Found | None
    there: bool


class Eyes:
    """The lasers of a body, its map, and what it keeps in mind.

    Args:
        body: whose lasers.
        parts: given parts by name: scan_filter and terrain count here.
        truck: its size, and where the order says that it stands.
        seed: of the ranges' noise.

    Attributes:
        map: heights with variance.
        truck: `Found` last, or None.
        views: of all looks.
        lost: how many looks were lost or late.
    """

    def __init__(self, body: Body, parts: dict, truck: Truck, seed: int) -> None:
        self.body, self._size = body, truck
        self._filter = parts.get("scan_filter", shadow_filter)
        make = parts.get("terrain", TerrainMap)
        self.map = call_part("terrain", make, *AREA)
        for name in ("insert", "heights", "variance"):
            if not hasattr(self.map, name):
                raise TypeError(f"your terrain failed: it must have {name}, got {short(self.map)}")
        self.truck, self.views, self.lost = None, [], 0
        self._scanner = Scanner(body.world, EYES, seed)

    def look(self, event: str) -> View:
        """Stand still for half a nod of both lasers, and make of it what can be made.

        Raises:
            Halt: too many looks after another were lost.
        """
        for _ in range(TRIES):
            view = self._look(event)
            if view is not None:
                return view
            self.lost += 1
        raise Halt(f"{event}: {TRIES} looks after another were lost or too late")

    def there(self) -> bool:
        """Whether the truck is where it was found last."""
        return self._scanner.sight.truck

    def _look(self, event: str) -> View | None:
        body, fault, number = self.body, self.body.fault, len(self.views) + self.lost
        world, belief, q = body.world, body.pose, body.world.q
        body.begin(event)
        pose, time = world.pose, world.time
        self._scanner.sight.truck = fault.truck_there(body.loads, q[0])
        scans = {
            name: self._scanner.scan(laser, Motion.standing(q, pose), laser.sweep_lines)
            for name, laser in EYES.items()
        }
        body.hold(SWEEP)
        delay = fault.delay(number)
        body.hold(min(delay, STALE))
        if delay > STALE:
            return None
        motion = Motion.standing(q, belief)
        points = np.concatenate([self._points(scan, motion, number) for scan in scans.values()])
        if len(points) < FEW:
            return None
        soil = is_soil(points)
        things = points[~soil & (points[:, 2] > ABOVE)]
        self.truck = _find(things, self._size, self.truck)
        if self.truck is not None:
            soil &= ~_on(points, self.truck, self._size)
        eye = sensor_poses(EYES["left"].mount, 0.0, motion)[:3, 3]
        call_part("terrain", self.map.insert, points[soil], eye, time)
        view = View(
            event,
            time,
            belief,
            pose,
            q,
            (points[soil], things),
            (np.array(self.map.heights), world.ground.terrain.heights.copy()),
            self.truck,
            self._scanner.sight.truck,
        )
        self.views.append(view)
        return view

    def _points(self, scan: object, motion: Motion, number: int) -> NDArray:
        """Of a laser, off the machine and without shadows, in the believed world, (n, 3) [m]."""
        ranges = self.body.fault.ranges(number, scan.ranges)
        points = deskew(scan.laser, scan.time, ranges, motion)
        origin = sensor_poses(scan.laser.mount, 0.0, motion)[:3, 3]
        kept = _kept(self._filter, points, origin) & np.isfinite(ranges)
        points = points[kept]
        if not len(points):
            return points
        return points[self_filter(points, _volumes(), motion.link_poses(0.0))]


def _kept(part: Callable, points: NDArray, origin: NDArray) -> NDArray:
    def asked(points: NDArray, origin: NDArray) -> NDArray:
        return truths(part(points, origin), "its answer", points.shape[:2])

    return call_part("scan_filter", asked, points, origin)


@lru_cache(maxsize=1)
def _volumes() -> dict:
    return link_volumes(links=("undercarriage", *JOINTS))


def _find(things: NDArray, size: Truck, before: Found | None) -> Found | None:
    """The truck among points on things (n, 3) [m], or None.

    Its place is shifted until the points lie on its surface: first by trying, then by the mean of
    what is left over (a registration with a known heading).
    """
    if len(things) < FEWEST:
        return None
    tree, rng = _surface(size), np.random.default_rng(0)
    some = things[rng.permutation(len(things))[:150]]
    if before is None:
        start = np.median(things[:, :2], axis=0)
        around = np.arange(-2.8, 2.81, 0.4)
    else:
        start, around = np.array(before[:2]), np.arange(-0.4, 0.41, 0.2)
    tried = [(start[0] + dx, start[1] + dy) for dx in around for dy in around]
    off = [_off(tree, some[::2], place)[0].clip(max=0.5).mean() for place in tried]
    place = np.array(tried[int(np.argmin(off))])
    some = _not_load(some, place, size)
    for _ in range(20):
        distance, nearest = _off(tree, some, place)
        close = distance < 0.3
        if close.sum() < len(some) / 2:
            return None
        step = (some[close] - nearest[close] - [*place, 0.0])[:, :2].mean(axis=0)
        place = place + step
        if np.abs(step).max() < 1e-3:
            break
    things = _not_load(things, place, size)
    share = float(np.mean(_off(tree, things, place)[0] < NEAR))
    return Found(*place.tolist(), share, len(things)) if share > ENOUGH else None


def _on(points: NDArray, truck: Found, size: Truck, beside: float = 0.2) -> NDArray:
    """Which points (n, 3) [m] are on the bed of a truck, or just beside it, (n,)."""
    x, y = np.abs(points[:, :2] - truck[:2]).T
    return (x < size.bed_length / 2 + beside) & (y < size.bed_width / 2 + beside)


def _not_load(points: NDArray, place: NDArray, size: Truck, wall: float = 0.12) -> NDArray:
    """Points (n, 3) [m] that are not within the bed of a truck at a place: soil may lie there."""
    x, y = np.abs(points[:, :2] - place).T
    within = (x < size.bed_length / 2 - wall) & (y < size.bed_width / 2 - wall)
    return points[~(within & (points[:, 2] > size.floor - wall))]


def _off(tree: object, points: NDArray, place: NDArray) -> tuple[NDArray, NDArray]:
    """Distances (n,) [m] of points from a truck at a place, and the nearest points of it (n, 3)."""
    distance, index = tree.query(points - [*place, 0.0], distance_upper_bound=1.0)
    return distance, tree.data[np.minimum(index, tree.n - 1)]


@lru_cache(maxsize=4)
def _surface(size: Truck, spacing: float = 0.08) -> object:
    """Points all over a truck's surface about its bed's middle, for nearest neighbours."""
    from scipy.spatial import cKDTree

    found = []
    for part in truck_visuals(size):
        for a, b, c in part.vertices[part.faces]:
            n = int(np.ceil(max(np.linalg.norm(b - a), np.linalg.norm(c - a)) / spacing)) + 1
            u, v = (share.ravel() for share in np.meshgrid(*[np.linspace(0, 1, n)] * 2))
            u, v = u[u + v < 1 + 1e-9, None], v[u + v < 1 + 1e-9, None]
            found.append(a + u * (b - a) + v * (c - a))
    return cKDTree(np.concatenate(found) - [size.x, size.y, 0.0])


def filled(heights: NDArray) -> NDArray:
    """Heights (n, m) [m] with those cells between the lasers' lines that have neighbours filled in:
    a mean of what is near, weighted by nearness; NaN stays where nothing is within `GAP`."""
    from scipy.ndimage import gaussian_filter

    known = np.isfinite(heights)
    cells = GAP / (3 * AREA[3])
    weight = gaussian_filter(known.astype(float), cells, truncate=3.0)
    total = gaussian_filter(np.where(known, heights, 0.0), cells, truncate=3.0)
    near = np.divide(total, weight, out=np.full(weight.shape, np.nan), where=weight > 1e-3)
    return np.where(known, heights, near)


def at(grid: NDArray, x: NDArray, y: NDArray) -> NDArray:
    """Values of the map's cells that hold places in the world [m]; NaN beyond the map."""
    corner, rows, columns, cell = AREA
    j, i = np.round((x - corner[0]) / cell), np.round((y - corner[1]) / cell)
    inside = (i >= 0) & (i < rows) & (j >= 0) & (j < columns)
    i, j = (np.where(inside, k, 0).astype(int) for k in (i, j))
    return np.where(inside, grid[i, j], np.nan)


class Ground:
    """The map with the gaps between the lasers' lines filled in, as `choice.polar` takes it."""

    def __init__(self, terrain: object) -> None:
        self.heights, self.variance = (
            filled(np.asarray(grid)) for grid in (terrain.heights, terrain.variance)
        )

    def grid(self) -> tuple[NDArray, NDArray]:
        """x and y of every height [m]."""
        (x, y), rows, columns, cell = AREA
        return tuple(np.meshgrid(x + cell * np.arange(columns), y + cell * np.arange(rows)))
