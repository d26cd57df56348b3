"""PyBullet, imported and connected without its banner.

The C library prints its build time on import; here the process's own file descriptors point to
nothing meanwhile, so that notebooks and logs stay the same on every machine.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType

MISSING = (
    "PyBullet is not installed. On Linux x86-64 with Python up to 3.11: pip install pybullet. "
    "On Windows and macOS: pip install pybullet_arm64. With conda: conda install -c conda-forge "
    'pybullet. Or go on without it: open_world(backend="analytic")'
)

_silencing = threading.Lock()


@contextmanager
def silence() -> Iterator[None]:
    """Send what C code prints to stdout and stderr into nothing."""
    with _silencing:
        sys.stdout.flush()
        sys.stderr.flush()
        kept = [os.dup(1), os.dup(2)]
        nothing = os.open(os.devnull, os.O_WRONLY)
        try:
            os.dup2(nothing, 1)
            os.dup2(nothing, 2)
            yield
        finally:
            for target, source in zip((1, 2), kept, strict=True):
                os.dup2(source, target)
                os.close(source)
            os.close(nothing)


def pybullet() -> ModuleType:
    """The PyBullet module.

    Raises:
        ImportError: it is not installed; the message says how to install it.
    """
    if sys.modules.get("pybullet") is not None:
        return sys.modules["pybullet"]
    try:
        with silence():
            return import_module("pybullet")
    except ImportError as error:
        raise ImportError(MISSING) from error


def connect() -> int:
    """A new headless physics server; returns its client id.

    Raises:
        ImportError: PyBullet is not installed.
        RuntimeError: the server does not start.
    """
    engine = pybullet()
    with silence():
        client = engine.connect(engine.DIRECT)
    if client < 0:
        raise RuntimeError(
            "PyBullet could not start another physics server: close some simulations"
        )
    return client
