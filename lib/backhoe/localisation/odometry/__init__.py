"""Odometry: where a vehicle is, from what its wheels and gyroscopes say.

- `dead_reckoning`: poses from velocities, by five methods; `sums`: the same in one axis
- `se2`: poses as a group; `streaming`: estimators that run sample by sample
- `robots`: Jacobians of wheeled and tracked robots; `tracked`: the backhoe's tracks
- `encoder`: ticks, counters that overflow
- `squares`, `calibration`: radii and gauge from squares, and from logs
- `convergence`: the order of a method, measured

Poses are (x, y, psi) [m, m, rad]; psi is never wrapped. Sides are in the order left, right.

Source: PUCP guide 2024; Mastalli 2013, sections 2.2 and 4.1.
"""

from backhoe.basics.se2 import compose, relative, se2_exp, se2_matrix
from backhoe.localisation.odometry import streaming
from backhoe.localisation.odometry.calibration import Calibration, calibrate
from backhoe.localisation.odometry.convergence import Motion, final_errors, order, winding
from backhoe.localisation.odometry.dead_reckoning import (
    METHODS,
    RULES,
    advance,
    from_samples,
    integrate,
    intervals,
)
from backhoe.localisation.odometry.encoder import Encoder
from backhoe.localisation.odometry.robots import Robot, differential, mecanum, omni, tracks
from backhoe.localisation.odometry.squares import Umbmark, square, umbmark, umbmark_exact
from backhoe.localisation.odometry.sums import bilinear_sum, euler_sum
from backhoe.localisation.odometry.tracked import Wheels, from_angles

__all__ = [
    "METHODS",
    "RULES",
    "Calibration",
    "Encoder",
    "Motion",
    "Robot",
    "Umbmark",
    "Wheels",
    "advance",
    "bilinear_sum",
    "calibrate",
    "compose",
    "differential",
    "euler_sum",
    "final_errors",
    "from_angles",
    "from_samples",
    "integrate",
    "intervals",
    "mecanum",
    "omni",
    "order",
    "relative",
    "se2_exp",
    "se2_matrix",
    "square",
    "streaming",
    "tracks",
    "umbmark",
    "umbmark_exact",
    "winding",
]
