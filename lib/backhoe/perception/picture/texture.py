"""A texture that stereo can match: smooth noise of several scales that repeats without a seam.

Its finest grain is 4 cm, several pixels wide where a stereo pair looks at; noise of single pixels
would look different from each eye.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import number, numbers, positive, whole

WAVELENGTHS = (0.04, 0.08, 0.16, 0.32, 0.64)
"""Of the noise [m]."""

MOST_PIXELS = 1 << 12
"""Along a side of a tile."""


def smooth_noise(
    seed: int, wavelengths: Sequence[float] = WAVELENGTHS, side: float = 10.24, pixels: int = 1024
) -> NDArray:
    """Noise that repeats every `side`: a sum of bands, each of standard deviation 1 [1].

    Args:
        seed: 0 or more; the same seed gives the same noise.
        wavelengths: about which each band lies, shape (n,) [m].
        side: of the tile [m].
        pixels: of the tile, along each side.

    Returns:
        Shape (pixels, pixels) [1]: mean 0, variance about the number of bands.

    Raises:
        ValueError: a number out of range.
    """
    numbers(wavelengths, "wavelengths", ("n",), meaning="lengths [m]")
    pixels, side = (
        whole(pixels, "pixels", least=8, most=MOST_PIXELS),
        number(side, "side", "m", least=1e-3, most=1e6),
    )
    rng = np.random.default_rng([whole(seed, "seed", least=0), 7])
    waves = np.fft.rfft2(rng.standard_normal((pixels, pixels)))
    per_metre = np.hypot(
        np.fft.fftfreq(pixels, side / pixels)[:, None], np.fft.rfftfreq(pixels, side / pixels)
    )
    noise = np.zeros((pixels, pixels))
    for wavelength in wavelengths:
        band = np.exp(-(((per_metre * wavelength) - 1) ** 2) / 0.18)
        octave = np.fft.irfft2(waves * band, (pixels, pixels))
        noise += octave / octave.std()
    return noise


@dataclass(frozen=True)
class Texture:
    """A tile of noise with coarser and coarser copies, for surfaces seen from further and further.

    Attributes:
        levels: all copies, one after the other, each half as wide as the one before, (n,) [1].
        pixels: of the first along each side; a power of two.
        side: of the tile [m].

    Raises:
        ValueError: pixels is no power of two, another number of levels, or a side not above 0.
    """

    levels: NDArray
    pixels: int
    side: float

    def __post_init__(self) -> None:
        pixels = _power_of_two(self.pixels, 2)
        levels = numbers(self.levels, "levels", ((4 * pixels * pixels - 1) // 3,))
        object.__setattr__(self, "levels", np.ascontiguousarray(levels))
        object.__setattr__(self, "side", positive(self.side, "side", "m"))

    @classmethod
    def of_noise(cls, seed: int, side: float = 10.24, pixels: int = 1024) -> Texture:
        """Smooth noise of standard deviation 1 [1] on a tile of `side` [m]; see `smooth_noise`.

        Raises:
            ValueError: pixels is no power of two, or as `smooth_noise` raises.
        """
        _power_of_two(pixels, 8)
        level = smooth_noise(seed, WAVELENGTHS, side, pixels) / np.sqrt(len(WAVELENGTHS))
        levels = [level.ravel()]
        while len(level) > 1:
            level = (level[::2, ::2] + level[1::2, ::2] + level[::2, 1::2] + level[1::2, 1::2]) / 4
            levels.append(level.ravel())
        return cls(np.concatenate(levels), pixels, side)


def _power_of_two(pixels: int, least: int) -> int:
    if whole(pixels, "pixels", least=least, most=MOST_PIXELS) & (pixels - 1):
        raise ValueError(f"pixels must be a power of two, got {pixels}")
    return pixels
