"""Random postures, variants of the machine and a diagnosis that several exercises share."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.machine import BACKHOE, Machine, replace

RADIANS = "the angles come in radians already: do not convert them again"


def postures(rng: np.random.Generator, count: int) -> NDArray:
    """Random joint angles within the limits, shape (count, 4) [rad]."""
    return rng.uniform(BACKHOE.lower, BACKHOE.upper, (count, 4))


def variant(machine: Machine = BACKHOE, **changes: dict) -> Machine:
    """A variant with some numbers of some links changed: boom={"mass": 1.0}."""
    return replace(
        machine, **{name: replace(getattr(machine, name), **new) for name, new in changes.items()}
    )
