"""How far along a path something has come: its foot, the nearest point, moves forwards only."""

from __future__ import annotations

from math import hypot, inf

import numpy as np
from numpy.typing import NDArray

from backhoe.vehicle.tracking.polyline import arc_length

_TIE = 1e-9


class Foot:
    """The foot on a path of something that moves along it: how far it has come.

    The nearest point is looked for from the last foot to `window` ahead. So a crossing does not
    lead to the other branch, nor the start of a closed path to its end.

    Args:
        points: the path, shape (n, 2) [m], checked.
        window: how far ahead the foot may move at a time [m].

    Attributes:
        arc: way along the path to each point [m].
        segments: x, y of the start, x, y of the direction and length of each [m].
        way: way along the path to the foot [m].
        segment: number of the foot's segment.
        distance: from the thing to its foot [m].
        place: x, y of the foot [m].
    """

    def __init__(self, points: NDArray, window: float) -> None:
        steps = np.diff(points, axis=0)
        lengths = np.hypot(*steps.T)
        units = steps / np.where(lengths > 0, lengths, 1.0)[:, None]
        self.window = window
        self.arc: list[float] = arc_length(points).tolist()
        self.segments = np.column_stack([points[:-1], units, lengths]).tolist()
        self.way, self.segment, self.distance = 0.0, 0, inf
        self.place = tuple(points[0].tolist())

    def move_to(self, x: float, y: float, limit: float = inf) -> None:
        """Move the foot on for the position (x, y) [m]; where two are as near, to the first.

        Args:
            x, y: position [m].
            limit: the foot stays within this way along the path [m], or where it is.
        """
        limit = max(min(limit, self.way + self.window), self.way)
        start, self.distance = self.way, inf
        for i in range(self.segment, len(self.segments)):
            if self.arc[i] > limit:
                break
            ax, ay, ux, uy, length = self.segments[i]
            first, last = max(start - self.arc[i], 0.0), min(length, limit - self.arc[i])
            t = min(max((x - ax) * ux + (y - ay) * uy, first), last)
            foot_x, foot_y = ax + t * ux, ay + t * uy
            distance = hypot(x - foot_x, y - foot_y)
            if distance < self.distance - _TIE:
                self.distance, self.segment = distance, i
                self.way, self.place = self.arc[i] + t, (foot_x, foot_y)
