"""The stereo pairs of lesson 08b: the simulated loading scene with its truth, and real rocks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, not_negative, numbers, whole

__all__ = ["LoadingPair", "loading", "rocks"]

_DATA = Path(__file__).resolve().parents[4] / "data" / "stereo"
_STEPS = 256
"""Of a stored disparity in a pixel."""


@dataclass(frozen=True)
class LoadingPair:
    """A rectified pair of the loading scene, arrays of shape (rows, columns).

    `left` and `right`, uint8; `disparity`, the true one [pixels], NaN for the sky; `surface`, an
    index of `names` or 255; `focal` length [pixels] and `baseline` [m].
    """

    left: NDArray
    right: NDArray
    disparity: NDArray
    surface: NDArray
    names: tuple[str, ...]
    focal: float
    baseline: float

    def shows(self, name: str) -> NDArray:
        """Where the left picture shows `name`, such as "truck", bool, shape (rows, columns) [1].

        Raises:
            ValueError: nothing has that name.
        """
        return self.surface == self.names.index(choice(name, "name", self.names))

    def hidden(self) -> NDArray:
        """Where something nearer hides from the right eye what the left one sees, bool, shape
        (rows, columns) [1].

        Two left pixels of a row that lie at one place of the right picture: the nearer one is seen.
        """
        d = np.nan_to_num(self.disparity)
        rows, columns = np.indices(d.shape)
        place = np.rint(columns - d).astype(int) + int(d.max()) + 2
        nearest = np.zeros((d.shape[0], place.max() + 2))
        for shift in (-1, 0, 1):
            np.maximum.at(nearest, (rows, place + shift), d)
        return nearest[rows, place] > d + 1.5

    def edges(self, window: int = 15) -> NDArray:
        """Where a window sees a jump of its row by more than 3 pixels, bool, shape (rows, columns)
        [1].

        Args:
            window: its side, odd [pixels].

        Raises:
            ValueError: no whole number above 0.
        """
        window = whole(window, "window", least=1)
        jumps = np.pad(np.abs(np.diff(np.nan_to_num(self.disparity))) > 3, ((0, 0), (0, 1)))
        for axis in (0, 1):
            spread = np.ones(window)
            jumps = np.apply_along_axis(np.convolve, axis, jumps, spread, "same") > 0
        return jumps

    def shares(self, disparity: ArrayLike, where: NDArray) -> tuple[float, float]:
        """Shares of some pixels that are answered, and that are wrong by more than a pixel [1].

        Args:
            disparity: shape (rows, columns) [pixels], NaN where none.
            where: the pixels that count, bool, same shape.

        Raises:
            ValueError: another shape, or no pixel that counts.
        """
        d = numbers(disparity, "disparity", self.disparity.shape, finite=False)[where]
        if not d.size:
            raise ValueError("where must hold at least one pixel that counts, got none")
        wrong = np.isfinite(d) & ~(np.abs(d - self.disparity[where]) <= 1)
        return float(np.isfinite(d).mean()), float(wrong.mean())

    def compare(self, maps: Mapping[str, ArrayLike], where: NDArray) -> str:
        """A table of `shares` [%] for maps (rows, columns): of all pixels, of the truck, of what
        is hidden.

        Args:
            maps: name -> disparities [pixels].
            where: the pixels that can be answered, bool, same shape.
        """
        parts = where, where & self.shows("truck"), where & self.hidden()
        lines = [f"{'':22s}    of all            of the truck      of the hidden"]
        lines.append(f"{'':22s}" + "  answered  wrong" * 3)
        for name, d in maps.items():
            shares = [share for part in parts for share in self.shares(d, part)]
            lines.append(f"{name:22s}" + ("  {:8.1%} {:6.1%}" * 3).format(*shares))
        return "\n".join(lines)


def loading(noise: float = 2.0, seed: int = 8) -> LoadingPair:
    """The loading scene, with the noise of a camera in both pictures.

    Args:
        noise: standard deviation [grey levels].
        seed: of the noise.

    Raises:
        ValueError: a number out of range.
    """
    noise = not_negative(noise, "noise", "grey levels")
    rng = np.random.default_rng(whole(seed, "seed", least=0))
    with np.load(_DATA / "loading.npz") as stored:
        left, right = (
            np.uint8(np.clip(np.rint(eye + noise * rng.standard_normal(eye.shape)), 0, 255))
            for eye in (stored["left"], stored["right"])
        )
        d = stored["disparity"] / _STEPS
        return LoadingPair(
            left,
            right,
            np.where(d > 0, d, np.nan),
            stored["surface"],
            tuple(map(str, stored["names"])),
            float(stored["focal"]),
            float(stored["baseline"]),
        )


def rocks() -> tuple[NDArray, NDArray]:
    """Left and right picture of a real heap of rocks, shape (555, 638), uint8 [grey levels]; nobody
    knows the truth."""
    with np.load(_DATA / "rocks.npz") as stored:
        return stored["left"], stored["right"]
