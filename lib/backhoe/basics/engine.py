"""Plain Python functions compiled by Numba: one text for the reader, for tests and for speed.

Only modules named as engines import this one: Numba takes half a second to load.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from zlib import crc32

from numba import njit


def compiled(*functions: Callable, **options: object) -> tuple[Callable, ...]:
    """The functions, compiled at their first call and kept on disk until their text changes.

    Where one of them calls another by its name, the compiled one calls the compiled one.

    Args:
        functions: arithmetic on arrays, numbers and tuples; their names differ.
        options: for Numba, such as `nogil=True` to let other threads run meanwhile.
    """
    files = sorted({function.__code__.co_filename for function in functions})
    version = crc32(b"".join(Path(file).read_bytes() for file in files) + str(options).encode())
    spaces = [dict(function.__globals__) for function in functions]
    fast = []
    for function, space in zip(functions, spaces, strict=True):
        plain = FunctionType(function.__code__, space, function.__name__, function.__defaults__)
        plain.__doc__, plain.__qualname__ = function.__doc__, f"{function.__name__}_{version:08x}"
        fast.append(njit(cache=True, **options)(plain))
    together = {plain.__name__: one for plain, one in zip(functions, fast, strict=True)}
    for space in spaces:
        space.update(together)
    return tuple(fast)
