"""Random postures, variants of the machine and a diagnosis that several exercises share."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.machine import BACKHOE, Machine, replace

RADIANS = "the angles come in radians already: do not convert them again"
LINKS = ("boom", "stick", "bucket")
BODIES = ("swing", *LINKS)
NOTHING = 1e-12  # a mass or an inertia that nothing feels


def postures(rng: np.random.Generator, count: int) -> NDArray:
    """Random joint angles within the limits, shape (count, 4) [rad]."""
    return rng.uniform(BACKHOE.lower, BACKHOE.upper, (count, 4))


def variant(*names: str, **changes: float | Callable) -> Machine:
    """The machine with some numbers of the named bodies changed, to a number or one of the body."""

    def changed(body: object) -> object:
        return replace(body, **{k: v(body) if callable(v) else v for k, v in changes.items()})

    return replace(BACKHOE, **{name: changed(getattr(BACKHOE, name)) for name in names})
