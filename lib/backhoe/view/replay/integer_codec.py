"""Whole numbers in few bytes: differences, then zigzag, then seven bits a byte.

Slowly changing integers have small differences, small differences take one byte, and repeated bytes
compress well. Zigzag maps 0, -1, 1, -2 ... to 0, 1, 2, 3 ...; a byte above 127 says that more
follow (the LEB128 of WebAssembly, DWARF and Protocol Buffers).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

_MOST_BYTES = 5


def pack(values: ArrayLike, order: int = 0) -> bytes:
    """Bytes of integers of any shape, flattened; `order` differences are taken first.

    Raises:
        ValueError: a value is not an integer, or a difference does not fit 32 bits.
    """
    values = np.asarray(values)
    integers = values.astype(np.int64).ravel()
    if values.size and not np.array_equal(integers, values.ravel()):
        raise ValueError("only whole numbers can be packed")
    for _ in range(order):
        integers = np.diff(integers, prepend=0)
    zigzag = (integers << 1) ^ (integers >> 63)
    if zigzag.max(initial=0) >= 1 << 32:
        raise ValueError("values to pack must stay within 32 bits")
    shifts = 7 * np.arange(_MOST_BYTES)
    groups = (zigzag[:, None] >> shifts) & 0x7F
    more = (zigzag[:, None] >> (shifts + 7)) > 0
    used = np.concatenate([np.ones((len(zigzag), 1), dtype=bool), more[:, :-1]], axis=1)
    return (groups | (more << 7))[used].astype(np.uint8).tobytes()


def unpack(data: bytes, order: int = 0) -> NDArray:
    """The integers of `pack`, shape (n,), int64.

    Raises:
        ValueError: the bytes end in the middle of a number.
    """
    raw = np.frombuffer(data, dtype=np.uint8).astype(np.int64)
    if not raw.size:
        return raw
    ends = np.flatnonzero(raw < 128)
    if not ends.size or ends[-1] != len(raw) - 1:
        raise ValueError("packed integers end in the middle of a number")
    starts = np.concatenate([[0], ends[:-1] + 1])
    place = np.arange(len(raw)) - np.repeat(starts, ends - starts + 1)
    zigzag = np.add.reduceat((raw & 0x7F) << (7 * place), starts)
    integers = (zigzag >> 1) ^ -(zigzag & 1)
    for _ in range(order):
        integers = np.cumsum(integers)
    return integers
