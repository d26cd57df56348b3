"""How well soil was graded: the finished surface beside its design, and where the soil went."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan, inf, nan

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, numbers, positive
from backhoe.mission.design import Design, TrenchDesign
from backhoe.mission.table import MARGIN_ROWS, table
from backhoe.simulation.scene import Scene
from backhoe.simulation.soil import Terrain

TOLERANCE = 0.05
"""What a finished surface may be off [m]."""


@dataclass(frozen=True, kw_only=True)
class SurfaceScore:
    """A graded surface in numbers, beside the reference's.

    Of the cells that count (`Design.mask`) and their errors, soil minus design: `share` of them
    within the tolerance [1], `mean`, `rms`, `p95` the 95th percentile of their size, `worst` [m].
    Of a trench's two edges, half its depth above the bottom: `bowed`, how far one is at most from
    the straight line through it [m], and `askew`, how far such a line is turned from the design
    [rad]; NaN for a slope.

    Volumes [m^3]: `surplus` above the design in the cells that count before the work; `cut` there
    and `filled` there; `elsewhere`, by how much the rest of the map has grown; `bucket` and
    `off_map`, what is in the bucket and beside the map at the end. `lost` must be nothing.

    Of the machine: `time` [s]; `margin` its least [m], at `margin_time` [s]; NaN if not given;
    `violations`, the share of the time in which more was asked of it than its limits allow [1], and
    how many strokes were `given_up`.
    """

    share: float
    mean: float
    rms: float
    p95: float
    worst: float
    bowed: float
    askew: float
    surplus: float
    cut: float
    filled: float
    elsewhere: float
    bucket: float
    off_map: float
    time: float = nan
    margin: float = nan
    margin_time: float = nan
    violations: float = 0.0
    given_up: int = 0
    swapped: tuple[str, ...] = ()
    reference: SurfaceScore | None = None

    @property
    def lost(self) -> float:
        """Soil that is nowhere [m^3]: 0 but for rounding."""
        return self.cut - self.filled - self.elsewhere - self.bucket - self.off_map

    def __str__(self) -> str:
        rows = [
            (f"within {100 * TOLERANCE:.0f} cm [%]", "{:.1f}", lambda s: 100 * s.share),
            ("mean error [cm]", "{:.1f}", lambda s: round(100 * s.mean, 1) + 0.0),
            ("rms error [cm]", "{:.1f}", lambda s: 100 * s.rms),
            ("95 % are within [cm]", "{:.1f}", lambda s: 100 * s.p95),
            ("worst error [cm]", "{:.1f}", lambda s: 100 * s.worst),
        ]
        if not np.isnan(self.bowed):
            rows += [
                ("edge off its line [cm]", "{:.1f}", lambda s: 100 * s.bowed),
                ("edge askew [deg]", "{:.1f}", lambda s: np.degrees(s.askew)),
            ]
        volumes = ("surplus", "cut", "filled", "elsewhere", "bucket", "off_map")
        rows += [
            (f"{name.replace('_', ' ')} [m^3]", "{:.2f}", lambda s, name=name: getattr(s, name))
            for name in volumes
        ]
        rows += [("lost [m^3]", "{:.2f}", lambda s: round(s.lost, 2) + 0.0)]
        if not np.isnan(self.margin):
            rows += [
                ("time [s]", "{:.1f}", lambda s: s.time),
                ("beyond limits [%]", "{:.1f}", lambda s: 100 * s.violations),
                ("strokes given up", "{:.0f}", lambda s: s.given_up),
                *MARGIN_ROWS,
            ]
        return table(self, rows)


def assess(
    design: Design,
    scene: Scene,
    before: ArrayLike,
    after: ArrayLike,
    *,
    bucket: float = 0.0,
    off_map: float = 0.0,
    tolerance: float = TOLERANCE,
    **machine: object,
) -> SurfaceScore:
    """Measure finished earthwork.

    Args:
        design: what it should be.
        scene: whose grid the heights are on.
        before, after: heights of the soil, shape (rows, columns) [m].
        bucket, off_map: soil in the bucket and beside the map after the work [m^3].
        tolerance: for `share` [m].
        machine: `time`, `margin`, `swapped` and the like of the score, if known.

    Raises:
        TypeError: design or scene is something else.
        ValueError: heights of another shape, or no cell that counts.
    """
    instance(design, "design", Design)
    before, after = (
        numbers(values, name, (scene.rows, scene.columns), meaning="of the scene's grid [m]")
        for values, name in ((before, "before"), (after, "after"))
    )
    errors = design.errors(after, scene)
    counts = np.isfinite(errors)
    if not counts.any():
        raise ValueError("no whole cell of the scene lies within the design")
    off, area = errors[counts], scene.cell**2
    grown = (after - before) * area
    bowed, askew = edges(design, scene, after) if isinstance(design, TrenchDesign) else (nan, nan)
    return SurfaceScore(
        share=float((np.abs(off) <= positive(tolerance, "tolerance", "m")).mean()),
        mean=float(off.mean()),
        rms=float(np.sqrt(np.mean(off**2))),
        p95=float(np.percentile(np.abs(off), 95)),
        worst=float(np.abs(off).max()),
        bowed=bowed,
        askew=askew,
        surplus=float(np.nansum(design.errors(before, scene)) * area),
        cut=-float(np.minimum(grown[counts], 0.0).sum()),
        filled=float(np.maximum(grown[counts], 0.0).sum()),
        elsewhere=float(grown[~counts].sum()),
        bucket=float(bucket),
        off_map=float(off_map),
        **machine,
    )


def edges(design: TrenchDesign, scene: Scene, heights: NDArray) -> tuple[float, float]:
    """How straight a trench's edges are; an edge is half the depth above the bottom.

    Args:
        design: its bottom.
        scene: whose grid.
        heights: of the soil, shape (rows, columns) [m].

    Returns:
        `bowed` [m] and `askew` [rad] of the worse edge, as in `SurfaceScore`; infinite and NaN
        where the soil stands that high in the middle, or not yet 2 m beside the bottom.
    """
    stations = max(int(design.run / scene.cell), 2)
    along = (np.arange(stations) + 0.5) * design.run / stations
    across = np.arange(0.0, design.width / 2 + 2.0, scene.cell / 4)
    terrain = Terrain(heights, scene.cell, scene.corner)
    last = np.array(scene.corner) + scene.cell * (np.array(heights.shape[::-1]) - 1)
    bowed = askew = 0.0
    for side in (-1, 1):
        points = design.point(along[:, None], side * across)
        z = terrain.height_at(np.clip(points[..., :2], scene.corner, last))
        over = z - points[..., 2] - design.depth / 2
        beyond = np.argmax(over >= 0, axis=1)
        if (beyond == 0).any():
            return inf, nan
        row = np.arange(stations)
        inner, outer = over[row, beyond - 1], over[row, beyond]
        line = across[beyond - 1] - inner / (outer - inner) * scene.cell / 4
        slope, middle = np.polyfit(along, line, 1)
        bowed = max(bowed, float(np.abs(line - slope * along - middle).max()))
        askew = max(askew, abs(atan(slope)))
    return bowed, askew
