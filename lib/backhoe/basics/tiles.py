"""Long batches in tiles that fit the processor's cache, shared among its cores.

NumPy and compiled loops let other threads run while they count, so plain threads are enough. Tiles
do not depend on each other: the numbers are the same on any number of cores.
"""

from __future__ import annotations

import os
from collections.abc import Callable

__all__ = ["cores", "for_each_tile"]

_WORTH_SHARING = 8


def for_each_tile(work: Callable[[slice], None], count: int, size: int) -> None:
    """Call `work` with consecutive slices that cover `count` items, `size` at a time.

    Args:
        work: does its own slice and nothing else; called from several threads when there are
            eight slices or more.
        count: number of items.
        size: items in a slice; the last may be shorter.
    """
    tiles = [slice(start, min(start + size, count)) for start in range(0, count, size)]
    threads = cores()
    if threads == 1 or len(tiles) < _WORTH_SHARING:
        for tile in tiles:
            work(tile)
        return
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(threads) as pool:
        for _ in pool.map(work, tiles):
            pass


def cores() -> int:
    """How many of the processor's cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
