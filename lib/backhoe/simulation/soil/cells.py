"""What happens to the cells of a heightmap: soil slides, falls, is cut and pressed out.

`terrain` calls these loops compiled (`engine`), records as plain tuples. u runs along the heading
from the bucket's tip, v across it to the right.
"""

from __future__ import annotations

from math import ceil, cos, floor, inf, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from backhoe.simulation.soil.bucket_pose import BucketPose

STEEPNESS_TOLERANCE = 1.005
"""A slope slides when it is steeper than the angle of repose by this factor."""
ACROSS = 13
"""Points on the bucket's width where soil falls and the depth is measured."""
ROUNDING = 1e-9
"""The edge may pass a cell twice, but it must not miss one between two steps."""


class Cells(NamedTuple):
    """A heightmap, its arrays changed in place.

    Attributes:
        heights: of the surface, y by x, shape (rows, columns) [m].
        floor: below which nothing is dug, the same shape [m].
        ceiling: above which no soil flows, the same shape [m].
        box: first row, end row, first column, end column of what may still slide, shape (4,).
        x, y: position of the first height [m].
        cell: spacing [m].
    """

    heights: NDArray
    floor: NDArray
    ceiling: NDArray
    box: NDArray
    x: float
    y: float
    cell: float


def grow(box, i, j, shape):
    """Enlarge the box so that it holds cell (i, j) and two cells around it."""
    box[0] = max(min(box[0], i - 2), 0)
    box[1] = min(max(box[1], i + 3), shape[0])
    box[2] = max(min(box[2], j - 2), 0)
    box[3] = min(max(box[3], j + 3), shape[1])


def lowest_neighbour(heights, ceiling, i, j, di, dj):
    """Drop to the lower of the two neighbours along one axis that has room, and its step."""
    h, drop, step = heights[i, j], 0.0, 0
    for s in (-1, 1):
        a, b = i + s * di, j + s * dj
        if 0 <= a < heights.shape[0] and 0 <= b < heights.shape[1]:
            down = h - heights[a, b]
            if down > drop and heights[a, b] < ceiling[a, b]:
                drop, step = down, s
    return drop, step


def slide(heights, base, ceiling, i, j, limit):
    """Let one cell slide down where its slope exceeds the limit (a drop per cell); True if it did.

    The slope is the length of the downhill gradient, so that heaps come out round. Soil stays
    above `base` and does not rise above `ceiling`.
    """
    drop_x, step_x = lowest_neighbour(heights, ceiling, i, j, 0, 1)
    drop_y, step_y = lowest_neighbour(heights, ceiling, i, j, 1, 0)
    steep = sqrt(drop_x * drop_x + drop_y * drop_y)
    if steep <= limit * STEEPNESS_TOLERANCE:
        return False
    excess = (1.0 - limit / steep) / (3.0 if step_x != 0 and step_y != 0 else 2.0)
    loose = heights[i, j] - base[i, j]
    if loose <= 0.0:
        return False
    slides = excess * (drop_x + drop_y)
    if slides > loose:
        excess *= loose / slides
    if step_x != 0:
        room = ceiling[i, j + step_x] - heights[i, j + step_x]
        moved = min(excess * drop_x, room)
        heights[i, j] -= moved
        heights[i, j + step_x] += moved
    if step_y != 0:
        room = ceiling[i + step_y, j] - heights[i + step_y, j]
        moved = min(excess * drop_y, room)
        heights[i, j] -= moved
        heights[i + step_y, j] += moved
    return True


def relax(cells, limit, sweeps):
    """Sweep over the box until nothing slides, at most `sweeps` times; returns sweeps with slides.

    The direction of the sweep turns, so that no side is favoured.
    """
    heights, base, ceiling, box, _, _, _ = cells
    shape = heights.shape
    moving = np.empty(4, np.int64)
    for sweep in range(sweeps):
        moving[0], moving[1], moving[2], moving[3] = shape[0], 0, shape[1], 0
        rows, columns = box[1] - box[0], box[3] - box[2]
        for a in range(rows):
            i = box[0] + a if sweep & 1 == 0 else box[1] - 1 - a
            for b in range(columns):
                j = box[2] + b if sweep & 2 == 0 else box[3] - 1 - b
                if slide(heights, base, ceiling, i, j, limit):
                    grow(moving, i, j, shape)
        for k in range(4):  # a slice would have its error message compiled along
            box[k] = moving[k]
        if box[0] >= box[1]:
            return sweep
    return sweeps


def drop_on(cells, x, y, volume):
    """Put a volume on the four cells around (x, y); False, and nothing done, off the map."""
    heights, cell = cells.heights, cells.cell
    a, b = (x - cells.x) / cell, (y - cells.y) / cell
    rows, columns = heights.shape
    if not (0.0 <= a <= columns - 1 and 0.0 <= b <= rows - 1):
        return False
    j, i = min(int(a), columns - 2), min(int(b), rows - 2)
    a, b, rise = a - j, b - i, volume / (cell * cell)
    heights[i, j] += (1 - a) * (1 - b) * rise
    heights[i, j + 1] += a * (1 - b) * rise
    heights[i + 1, j] += (1 - a) * b * rise
    heights[i + 1, j + 1] += a * b * rise
    grow(cells.box, i, j, heights.shape)
    return True


def height_at(cells, x, y):
    """Bilinear height, minus infinity off the map."""
    heights = cells.heights
    a, b = (x - cells.x) / cells.cell, (y - cells.y) / cells.cell
    rows, columns = heights.shape
    if not (0.0 <= a <= columns - 1 and 0.0 <= b <= rows - 1):
        return -inf
    j, i = min(int(a), columns - 2), min(int(b), rows - 2)
    a, b = a - j, b - i
    near = (1 - a) * heights[i, j] + a * heights[i, j + 1]
    far = (1 - a) * heights[i + 1, j] + a * heights[i + 1, j + 1]
    return (1 - b) * near + b * far


def lay(cells, start, end, z, volume):
    """Let a volume fall from height z evenly along the line start-end.

    Returns the volume that missed the map, or met soil higher than z.
    """
    cells, missed, share = Cells(*cells), 0.0, volume / ACROSS
    for k in range(ACROSS):
        part = (k + 0.5) / ACROSS
        x = start[0] + part * (end[0] - start[0])
        y = start[1] + part * (end[1] - start[1])
        if height_at(cells, x, y) >= z or not drop_on(cells, x, y, share):
            missed += share
    return missed


def overflow(bed, ground):
    """Move what lies on the walls (the outermost cells of the bed) to the ground beside them.

    Returns the volume that fell and how much of it missed the map.
    """
    bed, ground = Cells(*bed), Cells(*ground)
    cell, (rows, columns) = bed.cell, bed.heights.shape
    fell, missed = 0.0, 0.0
    for i in range(rows):
        on_end = i == 0 or i == rows - 1
        for j in range(0, columns, 1 if on_end else columns - 1):
            loose = (bed.heights[i, j] - bed.floor[i, j]) * cell * cell
            if loose > 0.0:
                bed.heights[i, j] = bed.floor[i, j]
                grow(bed.box, i, j, bed.heights.shape)
                fell += loose
                out_x = (j == columns - 1) * 2.0 - (j == 0) * 2.0
                out_y = (i == rows - 1) * 2.0 - (i == 0) * 2.0
                x, y = bed.x + (j + out_x) * cell, bed.y + (i + out_y) * cell
                if not drop_on(ground, x, y, loose):
                    missed += loose
    return fell, missed


def underside(shell_u, shell_z, u):
    """Lowest point of the shell's walls above or below position u; infinity beside the shell."""
    lowest = inf
    for k in range(len(shell_u) - 1):
        a, b = shell_u[k], shell_u[k + 1]
        if a != b and min(a, b) <= u <= max(a, b):
            z = shell_z[k] + (u - a) / (b - a) * (shell_z[k + 1] - shell_z[k])
            lowest = min(lowest, z)
    return lowest


def footprint(cells, here, u_low, u_high, across):
    """Rows and columns of the cells that a turned rectangle around the tip may cover."""
    low_x, high_x, low_y, high_y = inf, -inf, inf, -inf
    for u in (u_low, u_high):
        for v in (-across, across):
            x = here.tip[0] + u * here.heading[0] + v * here.heading[1]
            y = here.tip[1] + u * here.heading[1] - v * here.heading[0]
            low_x, high_x = min(low_x, x), max(high_x, x)
            low_y, high_y = min(low_y, y), max(high_y, y)
    return (
        max(ceil((low_y - cells.y) / cells.cell), 0),
        min(floor((high_y - cells.y) / cells.cell) + 1, cells.heights.shape[0]),
        max(ceil((low_x - cells.x) / cells.cell), 0),
        min(floor((high_x - cells.x) / cells.cell) + 1, cells.heights.shape[1]),
    )


def turned(profile, pitch):
    """The shell's profile, shape (n, 2), at a pitch: u and z from the tip, each of shape (n,)."""
    c, s = cos(pitch), sin(pitch)
    u, z = np.empty(len(profile)), np.empty(len(profile))
    for k in range(len(profile)):
        u[k] = profile[k, 0] * c - profile[k, 1] * s
        z[k] = profile[k, 0] * s + profile[k, 1] * c
    return u, z


def dig(cells, profile, half, last, here, sinkage):
    """Move the bucket from pose `last` to pose `here` through the soil of one map.

    The edge, 2 `half` wide, cuts each cell that it passes down to its path. Under the shell soil
    may stand up to `sinkage` into the wall (elastic), what is above is pressed out. The room left
    under the shell becomes the soil's ceiling; where the edge is in the soil none slips past it.

    Returns:
        Volume cut by the edge and volume pressed out by the shell [m^3]; area [m^2], mean depth and
        mean u [m] of the contact; least and greatest u of the shell [m]; first row, end row, first
        column, end column that it covers.
    """
    cells, last, here = Cells(*cells), BucketPose(*last), BucketPose(*here)
    heights, ceiling, cell = cells.heights, cells.ceiling, cells.cell
    tip, heading = here.tip, here.heading
    shell_u, shell_z = turned(profile, here.pitch)
    u_low, u_high = inf, -inf
    for u in shell_u:
        u_low, u_high = min(u_low, u), max(u_high, u)
    behind = -1.5 * cell if sin(here.pitch) > 0 else 1.5 * cell
    back = (last.tip[0] - tip[0]) * heading[0] + (last.tip[1] - tip[1]) * heading[1]
    aside = (last.tip[0] - tip[0]) * heading[1] - (last.tip[1] - tip[1]) * heading[0]
    covered = footprint(
        cells, here, min(u_low, back, behind), max(u_high, back, behind), half + abs(aside)
    )
    cut, pressed, touched, depth, lever = 0.0, 0.0, 0, 0.0, 0.0
    for i in range(covered[0], covered[1]):
        for j in range(covered[2], covered[3]):
            dx, dy = cells.x + j * cell - tip[0], cells.y + i * cell - tip[1]
            u = dx * heading[0] + dy * heading[1]
            v = dx * heading[1] - dy * heading[0]
            passed = u / back if back != 0.0 else -1.0
            if -ROUNDING <= passed <= 1.0 + ROUNDING and abs(v - passed * aside) <= half:
                path = max(tip[2] + passed * (last.tip[2] - tip[2]), cells.floor[i, j])
                if heights[i, j] > path:
                    cut += heights[i, j] - path
                    heights[i, j] = path
                    grow(cells.box, i, j, heights.shape)
            if abs(v) > half:
                continue
            if 0.0 <= u / behind <= 1.0 and heights[i, j] > tip[2] - cell:
                ceiling[i, j] = heights[i, j]
            wall = tip[2] + underside(shell_u, shell_z, u)
            if wall == inf:
                continue
            wall = max(wall, cells.floor[i, j])
            ceiling[i, j] = min(ceiling[i, j], wall)
            overlap = heights[i, j] - wall
            if overlap > 0.0:
                touched += 1
                depth += min(overlap, sinkage)
                lever += u
            if overlap > sinkage:
                pressed += overlap - sinkage
                heights[i, j] -= overlap - sinkage
            if overlap > -cell:
                grow(cells.box, i, j, heights.shape)
    area = cell * cell
    if touched > 0:
        depth, lever = depth / touched, lever / touched
    return cut * area, pressed * area, (touched * area, depth, lever), u_low, u_high, covered


def cut_depth(cells, here, u, half):
    """Mean height of the soil above the tip's level on a line across, at u along the heading."""
    cells, (tip, heading, _), total = Cells(*cells), here, 0.0
    for k in range(ACROSS):
        v = half * (2.0 * (k + 0.5) / ACROSS - 1.0)
        x = tip[0] + u * heading[0] + v * heading[1]
        y = tip[1] + u * heading[1] - v * heading[0]
        total += max(height_at(cells, x, y) - tip[2], 0.0)
    return total / ACROSS
