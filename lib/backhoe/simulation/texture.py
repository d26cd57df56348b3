"""The ground's texture: smooth noise of several scales that repeats without a seam.

The software renderer does not filter textures, so the finest grain is several pixels wide: from
4 cm up, as stereo matching needs it.
"""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

from backhoe.perception.picture.texture import smooth_noise

SIDE = 10.24
"""Side of one tile on the ground [m]."""

PIXELS = 1024
WAVELENGTHS = (0.04, 0.08, 0.16, 0.32, 0.64, 2.0)
EARTH = np.array([0.50, 0.40, 0.29])
PALE = np.array([0.66, 0.57, 0.43])


def ground(seed: int) -> NDArray:
    """One tile of earth, shape (PIXELS, PIXELS, 3), uint8."""
    noise = smooth_noise(seed, WAVELENGTHS, SIDE, PIXELS)
    shade = 0.5 + 0.16 * noise / np.sqrt(len(WAVELENGTHS)) * 1.6
    shade = np.clip(shade, 0.0, 1.0)[..., None]
    return np.uint8(255 * (EARTH + shade * (PALE - EARTH)))


def png(picture: NDArray) -> bytes:
    """An RGB picture (rows, columns, 3), uint8, as a PNG file."""
    rows, columns, _ = picture.shape
    lines = np.zeros((rows, 1 + 3 * columns), dtype=np.uint8)
    lines[:, 1:] = picture.reshape(rows, -1)
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in (
            (b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0)),
            (b"IDAT", zlib.compress(lines.tobytes(), 1)),
            (b"IEND", b""),
        )
    )
