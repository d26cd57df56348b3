"""RRT-Connect on the arm: the loops of `grow` and `arm_loops`, compiled together."""

from __future__ import annotations

from functools import cache

import numpy as np

from backhoe.basics.engine import compiled
from backhoe.planning.search import arm_loops, grow

connect, all_free, *_ = compiled(
    grow.connect,
    arm_loops.all_free,
    grow.extend,
    grow.distance,
    arm_loops.nearest,
    arm_loops.edge_free,
    arm_loops.free,
    arm_loops.in_box,
    arm_loops.ground,
    nogil=True,
    error_model="numpy",
)


@cache
def compile_now() -> None:
    """What is otherwise done at the first call, while a clock runs."""
    row, box, one = np.empty((0, 4)), np.empty((0, 2, 3)), np.ones(1, np.int64)
    world = arm_loops.World(
        *(np.zeros(9), np.zeros(4), np.zeros(4), one[:0], one[:0] > 0, row, row, box, box, box),
        *(np.zeros((2, 2)), np.ones(3), 1.0, one),
    )
    trees, none = np.empty((2, 1, 4)), np.zeros((2, 1), np.int64)
    connect(trees, none, np.ones(2, np.int64), row, 0, 1.0, 1.0, world)
