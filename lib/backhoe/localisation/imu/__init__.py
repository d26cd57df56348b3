"""An inertial measurement unit: what its sensors show, and what attitude follows from it.

- `board`: the numbers, those of the source's two boards for two
- `attitude`: from gravity, and from turning
- `readings`: what a board shows, its drift, its Allan deviation

Source: Mastalli 2013, section 4.4.
"""

from __future__ import annotations

from backhoe.localisation.imu.attitude import (
    attitude_from_gravity,
    body_rates,
    euler_rates,
    integrate,
    rotation,
)
from backhoe.localisation.imu.board import (
    BOARD_1,
    BOARD_2,
    IDEAL,
    PROVENANCE,
    STANDARD_GRAVITY,
    Board,
)
from backhoe.localisation.imu.readings import (
    Readings,
    allan_deviation,
    measure,
    specific_force,
    yaw_drift,
)

__all__ = [
    "BOARD_1",
    "BOARD_2",
    "IDEAL",
    "PROVENANCE",
    "STANDARD_GRAVITY",
    "Board",
    "Readings",
    "allan_deviation",
    "attitude_from_gravity",
    "body_rates",
    "euler_rates",
    "integrate",
    "measure",
    "rotation",
    "specific_force",
    "yaw_drift",
]
