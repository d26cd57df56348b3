"""Looking around while the machine works: clouds of three sensors, filtered, kept in one map.

A look is a sweep of both lasers and, at some, a stereo pair. Each sensor's points go through the
same steps: into the world, with the machine's pose at each beam's time; the shadows out
(`scan_filter`) or the pair matched (`matcher`); the machine itself out; one point a voxel; into the
`map`. What fell on the machine frees nothing beyond: its shadow stays unknown.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache, partial
from math import nan

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import numbers, positive, short, whole
from backhoe.machine import BACKHOE
from backhoe.mission.calls import call_part, given_parts, reset
from backhoe.mission.parts import SURVEY_PARTS
from backhoe.mission.records import Record
from backhoe.mission.truth import (
    CELL,
    RANGE,
    heap_heights,
    in_the_dark,
    truth_of,
    voxels,
)
from backhoe.mission.worksite import EYES, Look, worked
from backhoe.perception.cloud import Convex, hull, self_filter, shadow_filter, voxel_grid
from backhoe.perception.cloud.body import PADDING
from backhoe.perception.laser import deskew, directions, sensor_poses
from backhoe.perception.octree import OccupancyOctree
from backhoe.perception.stereo import block_match, reproject
from backhoe.simulation.scanning import Scan
from backhoe.simulation.scene import LOADING
from backhoe.view.appearance import visuals

FATTENED = 0.15
"""Padding of the self filter for stereo [m]: half a window of 15 pixels looks 9 cm past an edge
that is 7 m away, and gives what it sees there the edge's distance."""

DRIFT = 0.1
"""How far a laser moves while its lines count as one scan with one origin [m]."""

WRONG = 1.0
"""How far off the truth a disparity must be to be called wrong [pixels]."""


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points of one sensor in one look, in the world.

    Attributes:
        points: kept, shape (n, 3) [m].
        faults: shape (2,): of a laser, how many of all points lay more than 10 cm from what the
            middle of their beam meets, and how many of these were kept; of stereo, how many points
            there were, and how many had a wrong disparity.
        own: how many points that were kept lie on the machine.
        empty: just beyond `RANGE` on beams that met nothing, shape (m, 3) [m].
    """

    points: NDArray
    faults: NDArray
    own: int
    empty: NDArray


@dataclass(frozen=True, eq=False, kw_only=True)
class SurveyRun(Record):
    """What was seen and mapped, look by look; the truth is the simulation's.

    Attributes:
        events: what happened at each of the n looks; `time`, of their starts, shape (n,) [s].
        clouds: kept points of each sensor by its name, "left", "right" and at some looks "stereo";
            n of them.
        odds: what the map said after each look of the voxels' middles, `truth.voxels`, shape
            (n, x, y, z) [1], NaN where unknown.
        found: share of the voxels in which a look's beams truly end that the map then holds for
            occupied, these or the one above or below, shape (n,) [1].
        false: volume of what it holds for occupied a voxel or more from the true surface, (n,)
            [m^3].
        left: share of the truck's voxels, of those occupied at its last look, that still are, (n,)
            [1]; NaN while it is there.
        dark: share of the voxels deep in the ground that stay unknown to the last [1].
        heap: of "stereo" and "lasers", share of the heap's cells seen, root mean square and mean
            of their errors in height, shape (n, 3) [1, m, m]; NaN without points or pictures.
        dug: soil gone from the heap between the first look and the last as the lasers show it,
            and in truth, shape (2,) [m^3].
        map: as it is after the last look.
        looks: all that the eyes saw, `worksite.Look`s.
        resolution, cycles, seed: as given.
    """

    events: tuple[str, ...]
    time: NDArray
    clouds: tuple[dict[str, Cloud], ...]
    odds: NDArray
    found: NDArray
    false: NDArray
    left: NDArray
    dark: float
    heap: dict[str, NDArray]
    dug: NDArray
    map: object
    looks: tuple[Look, ...]
    resolution: float
    cycles: int
    seed: int
    SHOWN = (
        "mission.survey",
        "Look around",
        "3D replay of the backhoe digging and loading a truck",
    )


def survey(
    *,
    cycles: int = 1,
    matcher: Callable | None = None,
    scan_filter: Callable | None = None,
    map: Callable | None = None,
    resolution: float = 0.2,
    seed: int = 0,
    record: bool = False,
    **unknown: object,
) -> SurveyRun:
    """Dig, load the truck and look around, with the library's parts or with yours.

    The truck comes after the first look and leaves before the last ones. The machine is led along
    `hand_made_plan` without dynamics, so nothing here depends on a backend.

    Args:
        cycles: how many buckets.
        matcher, scan_filter, map: your parts; `SURVEY_PARTS` gives the call of each. What is left
            out is the library's.
        resolution: of the map [m].
        seed: of the ground's bumps and the sensors' noise.
        record: keep what the 3D replay needs; the truck stays in the picture when it has left.

    Returns:
        The run; `score` sets it beside the library's.

    Raises:
        ValueError: cycles, seed or resolution out of range, a part whose answer has the wrong shape
            or type or no value at all.
        TypeError: a part of an unknown name, one that cannot be called, or a map without
            insert_scan and log_odds.
    """
    given = given_parts(SURVEY_PARTS, unknown, matcher=matcher, scan_filter=scan_filter, map=map)
    cycles, seed = whole(cycles, "cycles", least=1), whole(seed, "seed", least=0)
    resolution = positive(resolution, "resolution", "m")
    for part in given.values():
        reset(part)
    chart = _Chart(given.get("map", OccupancyOctree), resolution)
    match = partial(_matched, given.get("matcher", block_match))
    keep = partial(_kept, given.get("scan_filter", shadow_filter))
    site, middles = worked(cycles, seed, bool(record)), voxels(resolution)
    clouds, odds = [], []
    for look in site.looks:
        seen = {name: _laser(look, scan, keep, chart) for name, scan in look.scans.items()}
        if look.pair is not None:
            seen["stereo"] = _stereo(look, match, chart)
        clouds.append(seen)
        odds.append(chart.log_odds(middles.reshape(-1, 3)).reshape(middles.shape[:3]))
    beyond = voxel_grid(np.concatenate([clouds[-1][name].empty for name in EYES]), resolution)
    return SurveyRun(
        swapped=tuple(given),
        machine=BACKHOE,
        backend=site.led.backend,
        recorder=site.recorder,
        events=tuple(look.event for look in site.looks),
        time=np.array([look.time for look in site.looks]),
        clouds=tuple(clouds),
        odds=np.array(odds),
        **_agreement(site.looks, np.array(odds), chart.log_odds(beyond), resolution),
        **_heap(site.looks, clouds),
        map=chart.map,
        looks=tuple(site.looks),
        resolution=resolution,
        cycles=cycles,
        seed=seed,
    )


def _agreement(
    looks: list[Look], odds: NDArray, beyond: NDArray, resolution: float
) -> dict[str, object]:
    """How map and truth agree; `beyond` is said of voxels further than scans may mark."""
    truths = [truth_of(look, resolution) for look in looks]
    full = odds >= 0
    thick = full.copy()
    thick[..., 1:] |= full[..., :-1]
    thick[..., :-1] |= full[..., 1:]
    volume = resolution**3
    false = [volume * (f & ~t.ground & ~t.truck).sum() for f, t in zip(full, truths, strict=True)]
    false[-1] += volume * (beyond >= 0).sum()
    last = max(k for k, look in enumerate(looks) if look.truck)
    truck = full[last] & truths[last].truck & ~truths[-1].ground
    return {
        "found": np.array([f[t.hit].mean() for f, t in zip(thick, truths, strict=True)]),
        "false": np.array(false),
        "left": np.array([f[truck].mean() if k > last else nan for k, f in enumerate(full)]),
        "dark": float(np.isnan(odds[-1][in_the_dark(looks, resolution)]).mean()),
    }


def _heap(looks: list[Look], clouds: list[dict[str, Cloud]]) -> dict[str, object]:
    found, heights = {"stereo": [], "lasers": []}, []
    for look, seen in zip(looks, clouds, strict=True):
        lasers = np.concatenate([seen[name].points for name in EYES])
        sets = {"lasers": lasers, "stereo": seen["stereo"].points if look.pair else lasers[:0]}
        for name, points in sets.items():
            z, error = heap_heights(points, look)
            there = error[np.isfinite(error)]
            none = not len(there)
            off = (nan, nan) if none else (np.sqrt(np.mean(there**2)), there.mean())
            found[name].append(
                (nan if look.pair is None and name == "stereo" else len(there) / len(z), *off)
            )
            if name == "lasers":
                heights.append(z)
    dug = np.nansum(heights[0] - heights[-1]) * CELL**2
    gone = (looks[0].terrain - looks[-1].terrain).sum() * LOADING.cell**2
    return {
        "heap": {name: np.array(rows) for name, rows in found.items()},
        "dug": np.array([dug, gone]),
    }


def _laser(look: Look, scan: Scan, keep: Callable, chart: _Chart) -> Cloud:
    world = deskew(scan.laser, scan.time, scan.ranges, look.motion)
    T = sensor_poses(scan.laser.mount, scan.time, look.motion)
    ahead = (T[..., :3, :3] @ directions(scan.laser, scan.time)[..., None])[..., 0]
    empty = T[..., :3, 3] + (RANGE + 1.0) * ahead
    nothing = np.isnan(scan.ranges)
    kept = np.zeros(nothing.shape, bool)
    for lines, origin in _from_one_place(T[..., :3, 3]):
        there = keep(world[lines], origin) & ~nothing[lines]
        kept[lines] = there
        for line in [lines] if look.motion.still else range(lines.start, lines.stop):
            off = off_the_machine(world[line][kept[line]], look, float(scan.time[line].mean()))
            kept[line][kept[line]] = off
        chart.insert(
            np.concatenate([world[lines][kept[lines]], empty[lines][nothing[lines]]]), origin
        )
    stray = scan.mixed & (np.minimum(scan.ranges, scan.truth) < RANGE)
    mine = np.isin(scan.surface, look.own) & ~scan.mixed
    faults = np.array([stray.sum(), (stray & kept).sum()])
    return Cloud(world[kept], faults, int((mine & kept).sum()), empty[nothing])


def _from_one_place(eyes: NDArray) -> Iterator[tuple[slice, NDArray]]:
    """Lines in which the laser, at (lines, beams, 3) [m], nearly stands, and where that is."""
    places = eyes.mean(axis=1)
    first = 0
    for line in range(1, len(places) + 1):
        if line == len(places) or np.linalg.norm(places[line] - places[first]) > DRIFT:
            yield slice(first, line), places[first:line].mean(axis=0)
            first = line


def _stereo(look: Look, match: Callable, chart: _Chart) -> Cloud:
    pair = look.pair
    disparity = match(pair.left, pair.right)
    points, pixels = reproject(disparity, pair.Q)
    points = points @ pair.T_world_camera[:3, :3].T + pair.T_world_camera[:3, 3]
    there = off_the_machine(points, look, padding=FATTENED)
    points, (rows, columns) = points[there], pixels[there].T
    chart.insert(points, pair.T_world_camera[:3, 3])
    true = pair.Q[2, 3] / pair.Q[3, 2] / pair.depth[rows, columns]
    right = np.abs(disparity[rows, columns] - true) < WRONG
    mine = np.isin(pair.surface[rows, columns], look.own) & right
    return Cloud(points, np.array([len(points), (~right).sum()]), int(mine.sum()), np.empty((0, 3)))


def off_the_machine(
    points: NDArray, look: Look, time: float = 0.0, padding: float = PADDING
) -> NDArray:
    """Which points (n, 3) [m] are on none of its links, as they are at a time of the look [s];
    shape (n,)."""
    if not len(points):
        return np.zeros(0, bool)
    return self_filter(points, volumes(), look.motion.link_poses(time), padding)


@lru_cache(maxsize=1)
def volumes() -> dict[str, list[Convex]]:
    """Convex hulls of what each link is drawn with."""
    return {link: [hull(part.vertices) for part in parts] for link, parts in visuals().items()}


class _Chart:
    """A map, the library's or a student's, whose answers are checked."""

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
        if len(points):
            thin = voxel_grid(points, self._resolution)
            call_part("map", self.map.insert_scan, thin, origin.copy(), RANGE)

    def log_odds(self, points: NDArray) -> NDArray:
        def asked(points: NDArray) -> NDArray:
            answer = self.map.log_odds(points)
            return numbers(answer, "what log_odds gives", (len(points),), finite=False)

        return call_part("map", asked, points)


def _matched(part: Callable, left: NDArray, right: NDArray) -> NDArray:
    def asked(left: NDArray, right: NDArray) -> NDArray:
        disparity = numbers(part(left, right), "its answer", left.shape, finite=False)
        if not np.isfinite(disparity).any():
            raise ValueError("its answer has no disparity anywhere: is left taken for right?")
        return disparity

    return call_part("matcher", asked, left, right)


def _kept(part: Callable, points: NDArray, origin: NDArray) -> NDArray:
    def asked(points: NDArray, origin: NDArray) -> NDArray:
        keep = np.asarray(part(points, origin))
        if keep.dtype != bool or keep.shape != points.shape[:2]:
            raise ValueError(
                f"its answer must be True or False for each point, shape {points.shape[:2]}, got "
                f"{keep.dtype} of shape {keep.shape}"
            )
        return keep

    return call_part("scan_filter", asked, points, origin)
