"""From what the eyes saw to points, and into the map, with the library's parts or a student's.

Each sensor's points go through the same steps: into the world, with the machine's pose at each
beam's time; the shadows out (`scan_filter`) or the pair matched (`matcher`); the machine itself
out; one point a voxel; into the `map`. What fell on the machine frees nothing beyond: its shadow
stays unknown.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import numbers, short, truths
from backhoe.machine import JOINTS
from backhoe.mission.calls import call_part
from backhoe.mission.parts import SURVEY_PARTS
from backhoe.mission.truth import RANGE
from backhoe.mission.worksite import Look
from backhoe.perception.cloud import Convex, self_filter, voxel_grid
from backhoe.perception.cloud.body import PADDING
from backhoe.perception.laser import deskew, directions, sensor_poses
from backhoe.perception.stereo import reproject
from backhoe.simulation.volumes import link_volumes

FATTENED = 0.15
"""Padding of the self filter for stereo [m]: half a window of 15 pixels looks 9 cm past an edge
that is 7 m away, and gives what it sees there the edge's distance."""

DRIFT = 0.1
"""How far a laser moves while its lines count as one scan with one origin [m]."""

WRONG = 1.0
"""How far off the truth a disparity must be to be called wrong [pixels]."""

BEYOND = RANGE + 1.0
"""How far a beam that meets nothing goes [m]; the map is told not to look that far."""


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points of one sensor in one look, in the world.

    Attributes:
        points: kept, shape (n, 3) [m].
        faults: shape (2,): of a laser, how many of all points lay more than 10 cm from what the
            middle of their beam meets, and how many of these were kept; of stereo, how many points
            there were, and how many had a wrong disparity.
        own: how many points that were kept lie on the machine.
        empty: `BEYOND` on beams that met nothing, shape (m, 3) [m].
    """

    points: NDArray
    faults: NDArray
    own: int
    empty: NDArray


class Chart:
    """A map, the library's or a student's, whose answers are checked; `map` is it itself.

    Args:
        make: the part.
        resolution: edge of a voxel [m].

    Raises:
        ValueError, TypeError: the part did, or what it made is no map.
    """

    def __init__(self, make: Callable, resolution: float) -> None:
        self._resolution = resolution
        self.map = call_part("map", make, resolution)
        for method in ("insert_scan", "log_odds"):
            if not callable(getattr(self.map, method, None)):
                raise TypeError(
                    f"your map failed: what it returns must have the method {method}, got "
                    f"{short(self.map)}. It is {SURVEY_PARTS['map'].call}"
                )

    def insert(self, points: NDArray, origin: NDArray) -> None:
        """Points (n, 3) of a scan from its origin (3,) [m]: one a voxel; the far ones only free."""
        if not len(points):
            return
        reach = points - origin
        reach *= np.minimum(1.0, BEYOND / np.linalg.norm(reach, axis=1, keepdims=True))
        thin = voxel_grid(origin + reach, self._resolution)
        call_part("map", self.map.insert_scan, thin, origin, RANGE)

    def log_odds(self, points: NDArray) -> NDArray:
        """What the map says of points (n, 3) [m], shape (n,) [1]."""

        def asked(points: NDArray) -> NDArray:
            answer = self.map.log_odds(points)
            return numbers(answer, "what log_odds gives", (len(points),), finite=False).copy()

        return call_part("map", asked, points)


def laser_cloud(look: Look, name: str, scan_filter: Callable, chart: Chart) -> Cloud:
    """What a laser saw in a look, put into the map.

    Args:
        look: of the machine at work.
        name: of the laser in `worksite.EYES`.
        scan_filter, chart: the part, and the map.
    """
    scan = look.scans[name]
    world = deskew(scan.laser, scan.time, scan.ranges, look.motion)
    T = sensor_poses(scan.laser.mount, scan.time, look.motion)
    ahead = (T[..., :3, :3] @ directions(scan.laser, scan.time)[..., None])[..., 0]
    empty = T[..., :3, 3] + BEYOND * ahead
    nothing = np.isnan(scan.ranges)
    kept = np.zeros(nothing.shape, bool)
    for lines, origin in _from_one_place(T[..., :3, 3]):
        kept[lines] = _kept(scan_filter, world[lines], origin) & ~nothing[lines]
        for line in [lines] if look.motion.still else range(lines.start, lines.stop):
            time = float(scan.time[line].mean())
            kept[line][kept[line]] = _off_the_machine(world[line][kept[line]], look, time)
        chart.insert(np.vstack([world[lines][kept[lines]], empty[lines][nothing[lines]]]), origin)
    stray = scan.mixed & (np.minimum(scan.ranges, scan.truth) < RANGE)
    mine = np.isin(scan.surface, look.own) & ~scan.mixed
    faults = np.array([stray.sum(), (stray & kept).sum()])
    return Cloud(world[kept], faults, int((mine & kept).sum()), empty[nothing])


def stereo_cloud(look: Look, matcher: Callable, chart: Chart) -> Cloud:
    """What the stereo pair of a look saw, put into the map; arguments as for `laser_cloud`."""
    pair = look.pair
    disparity = _matched(matcher, pair.left, pair.right)
    points, pixels = reproject(disparity, pair.Q)
    points = points @ pair.T_world_camera[:3, :3].T + pair.T_world_camera[:3, 3]
    there = _off_the_machine(points, look, padding=FATTENED)
    points, (rows, columns) = points[there], pixels[there].T
    chart.insert(points, pair.T_world_camera[:3, 3])
    true = pair.Q[2, 3] / pair.Q[3, 2] / pair.depth[rows, columns]
    right = np.abs(disparity[rows, columns] - true) < WRONG
    mine = np.isin(pair.surface[rows, columns], look.own) & right
    return Cloud(points, np.array([len(points), (~right).sum()]), int(mine.sum()), np.empty((0, 3)))


def _from_one_place(eyes: NDArray) -> Iterator[tuple[slice, NDArray]]:
    """Lines in which the laser, at (lines, beams, 3) [m], nearly stands, and where that is."""
    places = eyes.mean(axis=1)
    first = 0
    for line in range(1, len(places) + 1):
        if line == len(places) or np.linalg.norm(places[line] - places[first]) > DRIFT:
            yield slice(first, line), places[first:line].mean(axis=0)
            first = line


def _off_the_machine(
    points: NDArray, look: Look, time: float = 0.0, padding: float = PADDING
) -> NDArray:
    """Which points (n, 3) [m] are on none of its links, as they are at a time of the look [s];
    shape (n,)."""
    if not len(points):
        return np.zeros(0, bool)
    return self_filter(points, _volumes(), look.motion.link_poses(time), padding)


@lru_cache(maxsize=1)
def _volumes() -> dict[str, tuple[Convex, ...]]:
    return link_volumes(links=("undercarriage", *JOINTS))


def _matched(part: Callable, left: NDArray, right: NDArray) -> NDArray:
    def asked(left: NDArray, right: NDArray) -> NDArray:
        disparity = numbers(part(left, right), "its answer", left.shape, finite=False)
        if not np.isfinite(disparity).any():
            raise ValueError("its answer has no disparity anywhere: is left taken for right?")
        return disparity

    return call_part("matcher", asked, left, right)


def _kept(part: Callable, points: NDArray, origin: NDArray) -> NDArray:
    def asked(points: NDArray, origin: NDArray) -> NDArray:
        return truths(part(points, origin), "its answer", points.shape[:2])

    return call_part("scan_filter", asked, points, origin)
