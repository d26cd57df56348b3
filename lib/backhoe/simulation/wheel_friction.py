"""The friction of four wheels, integrated over one step of a simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from backhoe.vehicle.skid_steer import Vehicle

_TOLERANCE = 1e-6


class WheelFriction:
    """The slipping model over one step of this length [s]; loads and drives change step by step."""

    def __init__(self, vehicle: Vehicle, step: float) -> None:
        from backhoe.vehicle.skid_steer import engine

        self._advance, self._step = engine.advance, step
        self._fleet = engine.fleet([vehicle])
        self._wheel_inertia = vehicle.wheel_inertia
        self._length = np.full(1, step)

    def advance(
        self,
        state: NDArray,
        drive: NDArray,
        damping: NDArray,
        rotor_inertia: NDArray,
        loads: NDArray,
    ) -> None:
        """Bring state (10,) forward by one step in place; drive and loads of shape (4,)."""
        fleet = self._fleet
        fleet.damping[0], fleet.load[0] = damping, loads
        fleet.spin[0] = self._wheel_inertia + rotor_inertia
        self._advance(state[None], drive[None], fleet, self._step, self._length, _TOLERANCE)
