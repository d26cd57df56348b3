"""The steps of all simulations, and sample times that are whole multiples of them."""

from __future__ import annotations

from backhoe.basics.inputs import positive

STEP = 0.001
"""Length of one step [s]."""

TICKS_PER_DIG = 10
"""Steps between two visits to the soil: 100 Hz."""


def ticks(dt: float, step: float = STEP) -> int:
    """How many steps [s] there are in a sample time dt [s].

    Raises:
        ValueError: dt is no whole multiple of the step.
    """
    count = round(positive(dt, "dt", "s") / step)
    if count < 1 or abs(count * step - dt) > 1e-9:
        raise ValueError(f"dt must be a whole multiple of the step, {step} s, got {dt!r}")
    return count
