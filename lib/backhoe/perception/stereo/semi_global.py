"""Semi-global matching: each pixel listens to its neighbours, along eight ways to it.

Block matching decides each window alone. Here a pixel's disparity also pays for differing from its
neighbours', a little for a step of one (slopes) and much for any other (edges), along straight ways
through the picture. Source: Hirschmueller 2008, doi 10.1109/TPAMI.2007.1166, its equation (13);
the costs are windows' as in `block_matching`, smaller ones, where his are mutual information.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import alike, picture, whole
from backhoe.perception.stereo.block_matching import prefiltered, sweeper

WAYS = ((0, 1), (1, -1), (1, 0), (1, 1))
"""Steps (rows, columns) of half of the ways; the others are their opposites."""


def semi_global_match(
    left: NDArray,
    right: NDArray,
    *,
    disparities: int = 128,
    window: int = 5,
    prefilter: str = "sobel",
    cap: int = 63,
    small: int = 32,
    large: int = 128,
    uniqueness: int = 5,
    left_right: float | None = 1.0,
    speckle: int = 200,
    step: float = 1.0,
) -> NDArray:
    """Disparity of a rectified pair by semi-global matching.

    It takes four bytes a pixel and disparity: 160 MB for 640 x 480 and 128.

    Args:
        left, right: grey pictures, shape (rows, columns), uint8, rows aligned.
        disparities: tried from 0 on; as many columns less one stay without an answer.
        window: side of the window that is compared, odd [pixels].
        prefilter, cap: as for `block_match`.
        small, large: price of a step of one, and of a larger one, between neighbours' disparities
            [quarters of a grey level].
        uniqueness: by how much worse than the best each other disparity must be [percent].
        left_right, speckle, step: as for `block_match`.

    Returns:
        Disparities, shape (rows, columns) [pixels]; NaN where none is sure.

    Raises:
        ValueError: pictures that are not grey, uint8 and of one size; a parameter out of range.
    """
    left, right = picture(left, "left"), picture(right, "right")
    alike(left=left, right=right)
    disparities = whole(disparities, "disparities", least=2, most=left.shape[1])
    window = whole(window, "window", least=1, most=min(left.shape))
    if window % 2 == 0:
        raise ValueError(f"window must be odd, so that it has a middle, got {window}")
    small = whole(small, "small", least=0)
    large = whole(large, "large", least=small, most=4000)
    uniqueness = whole(uniqueness, "uniqueness", least=0, most=99)
    sweep = sweeper(left_right, speckle, step)
    left, right = (prefiltered(image, prefilter, cap=cap) for image in (left, right))

    from backhoe.perception.stereo import engine

    rows, columns = left.shape
    costs = np.empty((rows, columns, disparities), dtype=np.uint16)
    engine.window_costs(left, right, window // 2, costs, np.empty(columns, dtype=np.int32))
    total = np.zeros_like(costs)
    room = np.empty((2, columns + 2, disparities + 2), dtype=np.uint16)
    steps = np.uint16(small), np.uint16(large)
    for di, dj in WAYS:
        for turned in (False, True):
            engine.add_paths(costs, di, dj, turned, *steps, total, room)
    disparity = np.empty((rows, columns), dtype=np.float32)
    cost = np.zeros((rows, columns), dtype=np.uint16)
    engine.cheapest(total, uniqueness, disparity, cost)
    return sweep(disparity, cost)
