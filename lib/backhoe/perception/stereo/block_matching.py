"""Block matching: to each pixel of the left picture the likest window in the right one's row.

The steps and numbers are those of Mastalli 2013, section 5.2.3 (prefilter, search, texture
threshold, speckles), which are OpenCV's StereoBM; what the source does not print (uniqueness, the
speckles' step) is StereoBM's default. A disparity is the left column less the right one, x_l - x_r
[pixels], so the nearest depth is focal length times baseline over the largest disparity.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import alike, choice, not_negative, number, picture, positive, whole
from backhoe.basics.tiles import for_each_tile
from backhoe.perception.stereo.loops import LARGEST

PREFILTERS = ("normalised", "sobel")
STRIPES = 8
"""Parts of a picture that threads match side by side."""


def block_match(
    left: NDArray,
    right: NDArray,
    *,
    disparities: int = 128,
    window: int = 15,
    prefilter: str = "normalised",
    cap: int = 31,
    normalising: int = 9,
    texture: float = 10,
    uniqueness: int = 15,
    speckle: int = 200,
    step: float = 1.0,
    left_right: float | None = None,
) -> NDArray:
    """Disparity of a rectified pair by sums of absolute differences.

    Args:
        left, right: grey pictures, shape (rows, columns), uint8, rows aligned.
        disparities: tried from 0 on, a multiple of 16; as many columns less one on the left, and
            half a window around, stay without an answer.
        window: side of the window that is compared, odd [pixels].
        prefilter: see `prefiltered`, as `cap` and `normalising`.
        texture: least sum of the |prefiltered| pixels in a window.
        uniqueness: by how much worse than the best each disparity that is no neighbour of it must
            be [percent]; 0 for no such test.
        speckle: patches of up to so many pixels are dropped; 0 for none.
        step: most that neighbours in a patch differ [pixels].
        left_right: most that a pixel may differ from the one that matches its right pixel best
            [pixels]; None for no such test.

    Returns:
        Disparities, shape (rows, columns) [pixels], between whole ones by the lines through the
        costs beside the best; NaN where none is sure.

    Raises:
        ValueError: pictures that are not grey, uint8 and of one size, or too small for the window
            and the disparities; a parameter out of range.
    """
    left, right = picture(left, "left"), picture(right, "right")
    alike(left=left, right=right)
    disparities = whole(disparities, "disparities", least=16)
    if disparities % 16:
        raise ValueError(f"disparities must be a multiple of 16, got {disparities}")
    half = _half(window, "window")
    rows, columns = left.shape
    if rows < window or columns < disparities - 1 + window:
        raise ValueError(
            f"{disparities} disparities and a window of {window} need pictures of at least "
            f"{window} rows and {disparities - 1 + window} columns, got shape {left.shape}"
        )
    texture = number(texture, "texture", least=0)
    uniqueness = whole(uniqueness, "uniqueness", least=0, most=100)
    sweep = sweeper(left_right, speckle, step)
    left, right = (
        prefiltered(image, prefilter, cap=cap, normalising=normalising) for image in (left, right)
    )
    if 2 * cap * window**2 > LARGEST:
        raise ValueError(
            f"window and cap must keep 2 cap window^2 within {LARGEST}, got {window} and {cap}"
        )

    from backhoe.perception.stereo import engine

    mirrored = np.ascontiguousarray(right[:, ::-1])
    disparity = np.full((rows, columns), np.nan, dtype=np.float32)
    cost = np.zeros((rows, columns), dtype=np.uint16)

    def match(part: slice) -> None:
        room = np.empty((columns - disparities + 1, disparities), dtype=np.uint16)
        engine.match_rows(
            left,
            mirrored,
            half + part.start,
            half + part.stop,
            half,
            cap,
            texture,
            uniqueness,
            room,
            disparity,
            cost,
        )

    count = rows - 2 * half
    for_each_tile(match, count, -(-count // STRIPES))
    return sweep(disparity, cost)


def sweeper(
    left_right: float | None, speckle: int, step: float
) -> Callable[[NDArray, NDArray], NDArray]:
    """What a matcher does last, its numbers checked first; as for `block_match`.

    Returns:
        A function of disparities and their costs, shape (rows, columns) [pixels, grey levels],
        which drops those that the right picture denies, then the speckles.

    Raises:
        ValueError: a number out of range.
    """
    if left_right is not None:
        left_right = not_negative(left_right, "left_right", "pixels")
    speckle = whole(speckle, "speckle", least=0, most=1 << 30)
    step = positive(step, "step", "pixels")

    def sweep(disparity: NDArray, cost: NDArray) -> NDArray:
        from backhoe.perception.stereo import engine

        rows, columns = disparity.shape
        if left_right is not None:
            best, claim = np.empty(columns, dtype=np.int64), np.empty(columns, dtype=np.float32)
            engine.keep_consistent(disparity, cost, left_right, best, claim)
        if speckle:
            parent, size = np.empty((2, rows * columns), dtype=np.int32)
            label = np.empty((rows, columns), dtype=np.int32)
            engine.drop_speckles(disparity, speckle, step, parent, size, label)
        return disparity.astype(float)

    return sweep


def prefiltered(
    image: NDArray, prefilter: str = "normalised", *, cap: int = 31, normalising: int = 9
) -> NDArray:
    """A picture made independent of its brightness: what two cameras see alike.

    Args:
        image: grey picture, shape (rows, columns), uint8.
        prefilter: "normalised", the pixel less the mean of its window, min[max(I - mean, -cap),
            cap], as Mastalli 2013, section 5.2.3, describes it (StereoBM's also smooths the pixel);
            or "sobel", its horizontal derivative, StereoBM's default.
        cap: clip of the response, at most 127 [grey levels].
        normalising: side of the normalising window, odd [pixels].

    Returns:
        Response plus cap, shape (rows, columns), uint8 [grey levels]; no texture gives cap.

    Raises:
        ValueError: no grey picture, an unknown prefilter, or a number out of range.
    """
    image = picture(image, "image")
    choice(prefilter, "prefilter", PREFILTERS)
    cap, half = whole(cap, "cap", least=1, most=127), _half(normalising, "normalising")

    from backhoe.perception.stereo import engine

    response = np.empty_like(image)
    if prefilter == "sobel":
        engine.sobel_response(image, cap, response)
    else:
        room = np.empty(image.shape[1], dtype=np.int32)
        engine.normalised_response(image, half, cap, response, room)
    return response


def _half(side: int, name: str) -> int:
    side = whole(side, name, least=3)
    if side % 2 == 0:
        raise ValueError(f"{name} must be odd, so that it has a middle, got {side}")
    return side // 2
