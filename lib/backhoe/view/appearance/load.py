"""The soil in the bucket."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.machine import BACKHOE, Machine
from backhoe.view.appearance.visual import SOIL, Visual
from backhoe.view.shapes import prism


def bucket_load(volume: float, machine: Machine = BACKHOE) -> Visual | None:
    """Soil in the bucket as a mesh in the bucket's frame, or None when there is too little to see.

    Args:
        volume: soil in the bucket [m^3]; above the struck capacity it stands as a heap.
    """
    shell = machine.shell
    inside = np.asarray(shell.profile, dtype=float)
    area = volume / shell.width
    if area < 1e-3:
        return None
    lip = inside[-1] / np.linalg.norm(inside[-1])
    depth_axis = np.array([lip[1], -lip[0]])
    depth_axis *= np.sign((inside @ depth_axis).sum())
    if area >= shell.section_area:
        heap = 2 * (area - shell.section_area) / np.linalg.norm(inside[-1])
        section = np.vstack([inside, inside[-1] / 2 - heap * depth_axis])
    else:
        section = _filled_section(inside, depth_axis, area)
    return Visual(*prism(section, -shell.width / 2, shell.width / 2), SOIL)


def _filled_section(inside: NDArray, depth_axis: NDArray, area: float) -> NDArray:
    """The part of the profile deeper than the level that leaves `area` below it."""
    depth = inside @ depth_axis
    low, high = 0.0, float(depth.max())
    for _ in range(40):
        level = (low + high) / 2
        section = _deeper_than(inside, depth, level)
        x, y = section.T
        if abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2 > area:
            low = level
        else:
            high = level
    return section


def _deeper_than(points: NDArray, depth: NDArray, level: float) -> NDArray:
    kept = []
    for i in range(len(points)):
        j = (i + 1) % len(points)
        if depth[i] >= level:
            kept.append(points[i])
        if (depth[i] >= level) != (depth[j] >= level):
            share = (level - depth[i]) / (depth[j] - depth[i])
            kept.append(points[i] + share * (points[j] - points[i]))
    return np.array(kept)
