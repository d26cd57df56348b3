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
    arm_loops.free_at,
    arm_loops.nearest,
    arm_loops.edge_free,
    arm_loops.ground,
    nogil=True,
    error_model="numpy",
)


@cache
def compile_now() -> None:
    """What is otherwise done at the first call, while a clock runs."""
    row, one = np.empty((0, 4)), np.ones(1, np.int64)
    zeros = [np.zeros(shape) for shape in (9, (2, 4), (0, 6), (0, 4), (0, 7), (2, 2), 5)]
    world = arm_loops.World(*zeros, one)
    trees, none = np.empty((2, 1, 4)), np.zeros((2, 1), np.int64)
    all_free(world, row)
    connect(trees, none, np.ones(2, np.int64), row, 0, 1.0, 1.0, world)
