"""Looking around while the machine works: clouds of three sensors, filtered, kept in one map.

A look is a sweep of both lasers and, at some, a stereo pair; `sensing` has what is done with it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import nan

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import positive, whole
from backhoe.machine import BACKHOE
from backhoe.mission.calls import given_parts, reset
from backhoe.mission.parts import SURVEY_PARTS
from backhoe.mission.records import Record
from backhoe.mission.sensing import Chart, Cloud, laser_cloud, stereo_cloud
from backhoe.mission.truth import CELL, heap_heights, in_the_dark, truth_of, voxels
from backhoe.mission.worksite import EYES, Look, worked
from backhoe.perception.cloud import shadow_filter, voxel_grid
from backhoe.perception.octree import OccupancyOctree
from backhoe.perception.stereo import block_match
from backhoe.simulation.scene import LOADING


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
    chart = Chart(given.get("map", OccupancyOctree), resolution)
    match, keep = given.get("matcher", block_match), given.get("scan_filter", shadow_filter)
    site, middles = worked(cycles, seed, bool(record)), voxels(resolution)
    clouds, odds = [], []
    for look in site.looks:
        seen = {name: laser_cloud(look, name, keep, chart) for name in EYES}
        if look.pair is not None:
            seen["stereo"] = stereo_cloud(look, match, chart)
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
        z, errors = heap_heights(np.concatenate([seen[name].points for name in EYES]), look)
        heights.append(z)
        found["lasers"].append(_off(errors))
        stereo = "stereo" in seen and _off(heap_heights(seen["stereo"].points, look)[1])
        found["stereo"].append(stereo or (nan, nan, nan))
    dug = np.nansum(heights[0] - heights[-1]) * CELL**2
    gone = (looks[0].terrain - looks[-1].terrain).sum() * LOADING.cell**2
    heap = {name: np.array(rows) for name, rows in found.items()}
    return {"heap": heap, "dug": np.array([dug, gone])}


def _off(errors: NDArray) -> tuple[float, float, float]:
    """Share of the cells that have an error, their root mean square and mean [1, m, m]."""
    there = errors[np.isfinite(errors)]
    if not len(there):
        return 0.0, nan, nan
    return len(there) / len(errors), float(np.sqrt(np.mean(there**2))), float(there.mean())
