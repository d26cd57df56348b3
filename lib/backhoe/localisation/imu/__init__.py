"""An inertial measurement unit: what its sensors show, and what attitude follows from it.

- `board`: the numbers, those of the source's two boards for two
- `attitude`: from gravity, and from turning
- `readings`: what a board shows, and its drift

Source: Mastalli 2013, section 4.4.
"""

from __future__ import annotations

from backhoe.localisation.imu.attitude import (
    attitude_from_gravity,
    euler_rates,
    integrate,
    rotation,
)
from backhoe.localisation.imu.board import BOARD_1, BOARD_2, Board
from backhoe.localisation.imu.readings import Readings, measure, specific_force, yaw_drift

__all__ = [
    "BOARD_1",
    "BOARD_2",
    "Board",
    "Readings",
    "attitude_from_gravity",
    "euler_rates",
    "integrate",
    "measure",
    "rotation",
    "specific_force",
    "yaw_drift",
]
