"""Exercises 8.5 to 8.8: whether both eyes agree, how far a pair sees, points, a whole matcher."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.perception import stereo

__all__ = ["EXERCISES"]


def working_range(
    f: float, B: float, disparities: int, sigma: float, most: float
) -> tuple[float, float]:
    """Depths between which a pair is good: the nearest that it can match, and the farthest whose
    standard deviation is `most` [m]."""
    return f * B / (disparities - 1), np.sqrt(most * f * B / sigma)


def _pairs_of_cameras(rng: np.random.Generator) -> list[tuple]:
    return [
        (
            rng.uniform(200, 900),
            rng.uniform(0.1, 0.8),
            int(16 * rng.integers(1, 17)),
            rng.uniform(0.03, 0.6),
            rng.uniform(0.02, 0.5),
        )
        for _ in range(30)
    ]


RANGE = Exercise(
    number="8.6",
    title="Between which depths",
    reference=working_range,
    cases=_pairs_of_cameras,
    oracle="the_last_disparity_and_the_slope_of_depth",
    mistakes={
        "the search starts at 0, so the largest disparity is one less than their number": (
            lambda f, B, n, sigma, most: (f * B / n, np.sqrt(most * f * B / sigma))
        ),
        "the farthest depth lacks its root: the deviation grows with the square of the depth": (
            lambda f, B, n, sigma, most: (f * B / (n - 1), most * f * B / sigma)
        ),
        "sigma is on the wrong side: a poorer disparity must shorten the range": (
            lambda f, B, n, sigma, most: (f * B / (n - 1), np.sqrt(most * f * B * sigma))
        ),
        "the baseline is missing: eyes farther apart see farther": (
            lambda f, B, n, sigma, most: (f / (n - 1), np.sqrt(most * f / sigma))
        ),
        "the nearest depth comes first, then the farthest": (
            lambda f, B, n, sigma, most: working_range(f, B, n, sigma, most)[::-1]
        ),
        "sigma_z = most is not used: that is the depth where one disparity is as much as sigma": (
            lambda f, B, n, sigma, most: (f * B / (n - 1), f * B / sigma)
        ),
    },
    hints=(
        "The nearest depth has the largest disparity that is tried. Which one is that?",
        "Set z^2 sigma / (f B) equal to most, and solve for z.",
    ),
    tested_on="30 random pairs of cameras",
)


def _right_winners(costs: NDArray) -> NDArray:
    seen = np.full_like(costs, np.inf)
    for d in range(len(costs)):
        seen[d, :, : costs.shape[2] - d] = costs[d, :, d:]
    return seen.argmin(axis=0)


def consistent(costs: NDArray) -> NDArray:
    """The left eye's winners, NaN where the right eye's differs by more than 1; (rows, columns).

    The right pixel (i, c) meets the left pixel (i, c + d) at the cost costs[d, i, c + d].
    """
    left, right = costs.argmin(axis=0), _right_winners(costs)
    i, j = np.indices(left.shape)
    agree = np.abs(right[i, j - left] - left) <= 1
    return np.where(agree & np.isfinite(costs.min(axis=0)), left, np.nan)


def _costs(rng: np.random.Generator) -> list[tuple]:
    """Two eyes that agree on half of the pixels; a few pixels without any cost."""
    cases = []
    for _ in range(12):
        disparities, rows, columns = rng.integers((5, 3, 14), (9, 6, 20))
        costs = rng.uniform(0, 1, (disparities, rows, columns))
        flat = rng.integers(0, disparities, (rows, 1)) + rng.integers(0, 2, (rows, columns))
        np.put_along_axis(costs, np.minimum(flat, disparities - 1)[None], 0.1, axis=0)
        costs += 0.2 * rng.uniform(0, 1, costs.shape)
        d, _, j = np.indices(costs.shape)
        costs[d > j] = np.inf
        costs[:, rng.random((rows, columns)) < 0.08] = np.inf
        cases.append((costs,))
    return cases


def _told(ask: Callable) -> Callable:
    """An answer that keeps the left winners where ask(left, right, i, j) says so."""

    def answer(costs: NDArray) -> NDArray:
        left, right = costs.argmin(axis=0), _right_winners(costs)
        keep = ask(left, right, *np.indices(left.shape))
        return np.where(keep & np.isfinite(costs.min(axis=0)), left, np.nan)

    return answer


CONSISTENT = Exercise(
    number="8.5",
    title="Do both eyes agree?",
    reference=consistent,
    cases=_costs,
    oracle="each_right_pixel_is_asked_by_itself",
    mistakes={
        "those are the left eye's winners: the right eye was not asked": (
            _told(lambda left, right, i, j: np.full(left.shape, True))
        ),
        "the right eye is asked at the left pixel's column: its own is j - d": (
            _told(lambda left, right, i, j: np.abs(right - left) <= 1)
        ),
        "the right pixel lies at j - d, not at j + d": (
            _told(
                lambda left, right, i, j: (
                    np.abs(right[i, np.minimum(j + left, left.shape[1] - 1)] - left) <= 1
                )
            )
        ),
        "a difference of 1 is allowed": (
            _told(lambda left, right, i, j: right[i, j - left] == left)
        ),
        "that keeps the pixels on which they disagree": (
            _told(lambda left, right, i, j: np.abs(right[i, j - left] - left) > 1)
        ),
        "a pixel without any finite cost has no answer either": (
            lambda costs: np.where(
                np.isfinite(costs.min(axis=0)), consistent(costs), costs.argmin(axis=0)
            )
        ),
        "no answer is NaN, not 0: zero is a disparity, infinitely far away": (
            lambda costs: np.nan_to_num(consistent(costs))
        ),
    },
    hints=(
        "costs[d, i, j] belongs to the left pixel j and the right pixel j - d. For the right eye, "
        "shift plane d by d columns to the left; what comes in from outside is infinite.",
        "right = shifted.argmin(axis=0); then compare left with right[i, j - left], i and j from "
        "np.indices(left.shape).",
    ),
    tested_on="12 random stacks of costs",
)


def points(disparity: NDArray, f: float, B: float, cx: float, cy: float) -> NDArray:
    """Points (n, 3) [m] of all pixels with a disparity above zero, row by row."""
    rows, columns = np.nonzero(np.isfinite(disparity) & (disparity > 0))
    z = f * B / disparity[rows, columns]
    return np.stack([(columns - cx) * z / f, (rows - cy) * z / f, z], axis=-1)


def _maps(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(15):
        rows, columns = rng.integers((4, 5), (8, 10))
        disparity = rng.uniform(2, 90, (rows, columns))
        holes = rng.permutation(rows * columns)[:8]
        disparity.flat[holes] = np.nan, np.nan, np.nan, 0.0, 0.0, -3.0, np.inf, -np.inf
        f, B = rng.uniform(300, 700), rng.uniform(0.1, 0.6)
        cases.append((disparity, f, B, *rng.uniform(0.5, 8, 2)))
    return cases


def _all_pixels(disparity: NDArray, f: float, B: float, cx: float, cy: float) -> NDArray:
    rows, columns = np.indices(disparity.shape).reshape(2, -1)
    with np.errstate(all="ignore"):
        z = f * B / disparity.ravel()
        return np.stack([(columns - cx) * z / f, (rows - cy) * z / f, z], axis=-1)


def _kept(keep: Callable) -> Callable:
    def answer(disparity: NDArray, *rest: float) -> NDArray:
        cloud = _all_pixels(disparity, *rest)
        with np.errstate(all="ignore"):
            return cloud[keep(cloud, disparity.ravel())]

    return answer


POINTS = Exercise(
    number="8.7",
    title="Holes are no points",
    reference=points,
    cases=_maps,
    oracle="two_lines_of_sight_by_least_squares",
    mistakes={
        "every pixel has become a point, also those without a disparity": _all_pixels,
        "NaN is gone, but a disparity of 0 still is a point, infinitely far away": (
            _kept(lambda cloud, d: ~np.isnan(d))
        ),
        "points behind the camera: a disparity below zero is no match": (
            _kept(lambda cloud, d: np.isfinite(cloud).all(axis=1) & np.isfinite(d))
        ),
        "an infinite disparity has become a point: in the lens itself": (
            _kept(lambda cloud, d: d > 0)
        ),
        "x and y are exchanged: the column gives x, the row y": (
            lambda d, f, B, cx, cy: points(d, f, B, cx, cy)[:, [1, 0, 2]]
        ),
        "the picture's middle is missing: subtract cx and cy": (
            lambda d, f, B, cx, cy: points(d, f, B, 0.0, 0.0)
        ),
        "y points up: in a camera's frame it points down, as the rows do": (
            lambda d, f, B, cx, cy: points(d, f, B, cx, cy) * (1, -1, 1)
        ),
        "they come column by column: go row by row": (
            lambda d, f, B, cx, cy: points(d.T, f, B, cy, cx)[:, [1, 0, 2]]
        ),
    },
    hints=(
        "Which pixels have a disparity that is finite and above zero? Take only those, and first.",
        "rows, columns = np.nonzero(good); then z, and x = (columns - cx) z / f.",
    ),
    tested_on="15 random maps with holes, zeros, and values below zero and infinite",
)


def matcher(left: NDArray, right: NDArray) -> NDArray:
    """The library's matcher with the lesson's numbers, and both eyes must agree."""
    return stereo.block_match(left, right, left_right=1.0)


def _shifted(rng: np.random.Generator) -> list[tuple]:
    """Smooth noise that one eye sees shifted and brighter, with an even plate in it."""
    cases = []
    for shift in rng.integers(15, 100, 3):
        noise = rng.standard_normal((60, 360))
        kernel = np.exp(-(np.linspace(-2.5, 2.5, 9) ** 2) / 2)
        for axis in (0, 1):
            noise = np.apply_along_axis(np.convolve, axis, noise, kernel, "same")
        wide = np.clip(110 + 30 * noise / noise.std(), 10, 210).astype(np.uint8)
        wide[10:50, 168:230] = 100
        cases.append((wide[:, :240].copy(), wide[:, shift : shift + 240] + np.uint8(30)))
    return cases


def _alike(answer: NDArray, right: NDArray, *_: NDArray) -> bool | str:
    """True for a map that answers where the library's does, and nearly the same."""
    answer = np.asarray(answer)
    if answer.shape != right.shape or answer.dtype.kind not in "fiu":
        return f"it must be a map of numbers, shape {right.shape}, got shape {answer.shape}"
    mine, theirs = np.isfinite(answer), np.isfinite(right)
    close = np.abs(answer - right)[mine & theirs] <= 1
    if (mine & ~theirs).sum() > 0.05 * theirs.sum():
        return "it answers many pixels that it cannot know: an even plate, the blind strip"
    if (mine & theirs).sum() < 0.8 * theirs.sum():
        return "it leaves too many pixels empty that can be matched"
    if close.mean() < 0.97:
        return "where it answers it is often wrong by more than a pixel"
    return True


MATCHER = Exercise(
    number="8.8",
    title="A matcher for the machine",
    reference=matcher,
    cases=_shifted,
    compare=_alike,
    oracle="each_window_is_its_partner_but_for_the_light",
    mistakes={
        "left and right are exchanged": lambda left, right: matcher(right, left),
        "its sign is turned: a disparity is x_left - x_right": (
            lambda left, right: -matcher(left, right)
        ),
        "those are sixteenths of a pixel, as StereoBM returns them": (
            lambda left, right: 16 * matcher(left, right)
        ),
        "no answer is NaN, not 0": lambda left, right: np.nan_to_num(matcher(left, right)),
        "no answer is NaN, not -1": (
            lambda left, right: np.nan_to_num(matcher(left, right), nan=-1.0)
        ),
        "it answers where there is no texture: the even plate cannot be matched": (
            lambda left, right: stereo.block_match(left, right, texture=0, uniqueness=0, speckle=0)
        ),
    },
    hints=(
        "Prefilter both eyes, then sad_costs, then keep what has texture, is unique, and agrees.",
        "costs = sad_costs(prefiltered left, prefiltered right); d = my_consistent(costs); NaN "
        "where not textured(left) or not unique(costs); the blind columns are NaN.",
    ),
    tested_on="three pairs, one eye brighter than the other",
    timeout=60.0,
)

EXERCISES = (CONSISTENT, RANGE, POINTS, MATCHER)
