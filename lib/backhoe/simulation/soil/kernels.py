"""Loops over the cells of a heightmap, compiled by numba on first use and kept on disk.

Only `terrain` and `soil` import this module, and only when soil moves: numba takes 0.5 s to import.
Heights are (rows, columns), y by x. A grid is (x, y, cell): position of the first height and the
spacing [m]. A box is (first row, end row, first column, end column), grown in place to take in
what changes. A heading is the horizontal unit vector of the arm's plane; u runs along it from the
bucket's tip.
"""

from __future__ import annotations

from math import ceil, cos, floor, inf, sin, sqrt

import numpy as np
from numba import njit

STEEPNESS_TOLERANCE = 1.005
"""A slope slides when it is steeper than the angle of repose by this factor."""
ACROSS = 13
"""Points on the bucket's width where soil falls and the depth is measured."""
ROUNDING = 1e-9
"""The edge may pass a cell twice, but it must not miss one between two steps."""


@njit(cache=True)
def grow(box, i, j, margin, shape):
    """Enlarge the box so that it holds cell (i, j) and `margin` cells around it."""
    box[0] = max(min(box[0], i - margin), 0)
    box[1] = min(max(box[1], i + margin + 1), shape[0])
    box[2] = max(min(box[2], j - margin), 0)
    box[3] = min(max(box[3], j + margin + 1), shape[1])


@njit(cache=True)
def clear(box, shape):
    """Make the box empty: its first rows and columns lie behind its ends."""
    box[0], box[1], box[2], box[3] = shape[0], 0, shape[1], 0


@njit(cache=True)
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


@njit(cache=True)
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


@njit(cache=True)
def relax(heights, base, ceiling, box, limit, sweeps):
    """Sweep over the box until nothing slides, at most `sweeps` times; returns sweeps with slides.

    The direction of the sweep turns, so that no side is favoured.
    """
    moving = np.empty(4, np.int64)
    for sweep in range(sweeps):
        clear(moving, heights.shape)
        rows, columns = box[1] - box[0], box[3] - box[2]
        for a in range(rows):
            i = box[0] + a if sweep & 1 == 0 else box[1] - 1 - a
            for b in range(columns):
                j = box[2] + b if sweep & 2 == 0 else box[3] - 1 - b
                if slide(heights, base, ceiling, i, j, limit):
                    grow(moving, i, j, 2, heights.shape)
        for k in range(4):
            box[k] = moving[k]
        if box[0] >= box[1]:
            return sweep
    return sweeps


@njit(cache=True)
def drop_on(heights, grid, x, y, volume, box):
    """Put a volume on the four cells around (x, y); False, and nothing done, off the map."""
    x0, y0, cell = grid
    a, b = (x - x0) / cell, (y - y0) / cell
    rows, columns = heights.shape
    if not (0.0 <= a <= columns - 1 and 0.0 <= b <= rows - 1):
        return False
    j, i = min(int(a), columns - 2), min(int(b), rows - 2)
    a, b, rise = a - j, b - i, volume / (cell * cell)
    heights[i, j] += (1 - a) * (1 - b) * rise
    heights[i, j + 1] += a * (1 - b) * rise
    heights[i + 1, j] += (1 - a) * b * rise
    heights[i + 1, j + 1] += a * b * rise
    grow(box, i, j, 2, heights.shape)
    return True


@njit(cache=True)
def height_at(heights, grid, x, y):
    """Bilinear height, minus infinity off the map."""
    x0, y0, cell = grid
    a, b = (x - x0) / cell, (y - y0) / cell
    rows, columns = heights.shape
    if not (0.0 <= a <= columns - 1 and 0.0 <= b <= rows - 1):
        return -inf
    j, i = min(int(a), columns - 2), min(int(b), rows - 2)
    a, b = a - j, b - i
    near = (1 - a) * heights[i, j] + a * heights[i, j + 1]
    far = (1 - a) * heights[i + 1, j] + a * heights[i + 1, j + 1]
    return (1 - b) * near + b * far


@njit(cache=True)
def lay(heights, grid, box, start, end, z, volume):
    """Let a volume fall from height z evenly along the line start-end.

    Returns the volume that missed the map, or met soil higher than z.
    """
    missed, share = 0.0, volume / ACROSS
    for k in range(ACROSS):
        part = (k + 0.5) / ACROSS
        x = start[0] + part * (end[0] - start[0])
        y = start[1] + part * (end[1] - start[1])
        if height_at(heights, grid, x, y) >= z or not drop_on(heights, grid, x, y, share, box):
            missed += share
    return missed


@njit(cache=True)
def overflow(bed, base, bed_grid, bed_box, heights, grid, box):
    """Move what lies on the walls (the outermost cells of the bed) to the ground beside them.

    Returns the volume that fell and how much of it missed the map.
    """
    x0, y0, cell = bed_grid
    rows, columns = bed.shape
    fell, missed = 0.0, 0.0
    for i in range(rows):
        on_end = i == 0 or i == rows - 1
        for j in range(0, columns, 1 if on_end else columns - 1):
            loose = (bed[i, j] - base[i, j]) * cell * cell
            if loose > 0.0:
                bed[i, j] = base[i, j]
                grow(bed_box, i, j, 2, bed.shape)
                fell += loose
                out_x = (j == columns - 1) * 2.0 - (j == 0) * 2.0
                out_y = (i == rows - 1) * 2.0 - (i == 0) * 2.0
                x, y = x0 + (j + out_x) * cell, y0 + (i + out_y) * cell
                if not drop_on(heights, grid, x, y, loose, box):
                    missed += loose
    return fell, missed


@njit(cache=True)
def underside(shell_u, shell_z, u):
    """Lowest point of the shell's walls above or below position u; infinity beside the shell."""
    lowest = inf
    for k in range(len(shell_u) - 1):
        a, b = shell_u[k], shell_u[k + 1]
        if a != b and min(a, b) <= u <= max(a, b):
            z = shell_z[k] + (u - a) / (b - a) * (shell_z[k + 1] - shell_z[k])
            lowest = min(lowest, z)
    return lowest


@njit(cache=True)
def footprint(shape, grid, tip, heading, u_low, u_high, across):
    """Rows and columns of the cells that a turned rectangle around the tip may cover."""
    x0, y0, cell = grid
    low_x, high_x, low_y, high_y = inf, -inf, inf, -inf
    for u in (u_low, u_high):
        for v in (-across, across):
            x = tip[0] + u * heading[0] + v * heading[1]
            y = tip[1] + u * heading[1] - v * heading[0]
            low_x, high_x = min(low_x, x), max(high_x, x)
            low_y, high_y = min(low_y, y), max(high_y, y)
    return (
        max(ceil((low_y - y0) / cell), 0),
        min(floor((high_y - y0) / cell) + 1, shape[0]),
        max(ceil((low_x - x0) / cell), 0),
        min(floor((high_x - x0) / cell) + 1, shape[1]),
    )


@njit(cache=True)
def turned(profile, pitch):
    """The shell's profile, shape (n, 2), at a pitch: u and z from the tip, each of shape (n,)."""
    c, s = cos(pitch), sin(pitch)
    u, z = np.empty(len(profile)), np.empty(len(profile))
    for k in range(len(profile)):
        u[k] = profile[k, 0] * c - profile[k, 1] * s
        z[k] = profile[k, 0] * s + profile[k, 1] * c
    return u, z


@njit(cache=True)
def dig(heights, base, ceiling, grid, box, profile, last, tip, heading, pitch, half, give):
    """Move the bucket from tip position `last` to `tip` through the soil of one map.

    The edge, 2 `half` wide, cuts each cell that it passes down to its path. Under the shell soil
    may stand up to `give` into the wall (elastic), what is above is pressed out. The room left
    under the shell becomes the soil's ceiling; where the edge is in the soil none slips past it.

    Returns:
        volume cut by the edge and volume pressed out by the shell [m^3]; area [m^2], mean depth and
        mean u [m] of the contact; least and greatest u of the shell [m]; covered rows and columns.
    """
    x0, y0, cell = grid
    shell_u, shell_z = turned(profile, pitch)
    u_low, u_high = inf, -inf
    for u in shell_u:
        u_low, u_high = min(u_low, u), max(u_high, u)
    behind = -1.5 * cell if sin(pitch) > 0 else 1.5 * cell
    back = (last[0] - tip[0]) * heading[0] + (last[1] - tip[1]) * heading[1]
    aside = (last[0] - tip[0]) * heading[1] - (last[1] - tip[1]) * heading[0]
    covered = footprint(
        heights.shape,
        grid,
        tip,
        heading,
        min(u_low, back, behind),
        max(u_high, back, behind),
        half + abs(aside),
    )
    cut, pressed, cells, depth, lever = 0.0, 0.0, 0, 0.0, 0.0
    for i in range(covered[0], covered[1]):
        for j in range(covered[2], covered[3]):
            dx, dy = x0 + j * cell - tip[0], y0 + i * cell - tip[1]
            u = dx * heading[0] + dy * heading[1]
            v = dx * heading[1] - dy * heading[0]
            passed = u / back if back != 0.0 else -1.0
            if -ROUNDING <= passed <= 1.0 + ROUNDING and abs(v - passed * aside) <= half:
                path = max(tip[2] + passed * (last[2] - tip[2]), base[i, j])
                if heights[i, j] > path:
                    cut += heights[i, j] - path
                    heights[i, j] = path
                    grow(box, i, j, 2, heights.shape)
            if abs(v) > half:
                continue
            if 0.0 <= u / behind <= 1.0 and heights[i, j] > tip[2] - cell:
                ceiling[i, j] = heights[i, j]
            wall = tip[2] + underside(shell_u, shell_z, u)
            if wall == inf:
                continue
            wall = max(wall, base[i, j])
            ceiling[i, j] = min(ceiling[i, j], wall)
            overlap = heights[i, j] - wall
            if overlap > 0.0:
                cells += 1
                depth += min(overlap, give)
                lever += u
            if overlap > give:
                pressed += overlap - give
                heights[i, j] -= overlap - give
            if overlap > -cell:
                grow(box, i, j, 2, heights.shape)
    area = cell * cell
    if cells > 0:
        depth, lever = depth / cells, lever / cells
    return cut * area, pressed * area, cells * area, depth, lever, u_low, u_high, covered


@njit(cache=True)
def cut_depth(heights, grid, tip, heading, u, half):
    """Mean height of the soil above the tip's level on a line across, at u along the heading."""
    total = 0.0
    for k in range(ACROSS):
        v = half * (2.0 * (k + 0.5) / ACROSS - 1.0)
        x = tip[0] + u * heading[0] + v * heading[1]
        y = tip[1] + u * heading[1] - v * heading[0]
        total += max(height_at(heights, grid, x, y) - tip[2], 0.0)
    return total / ACROSS
