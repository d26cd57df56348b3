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

from backhoe.odometry import streaming
from backhoe.odometry.calibration import Calibration, calibrate
from backhoe.odometry.convergence import Motion, final_errors, order, winding
from backhoe.odometry.dead_reckoning import (
    METHODS,
    RULES,
    advance,
    from_samples,
    integrate,
    integrate_body,
    intervals,
)
from backhoe.odometry.encoder import Encoder
from backhoe.odometry.robots import Robot, differential, mecanum, omni, tracks
from backhoe.odometry.se2 import compose, relative, se2_exp, se2_log, se2_matrix
from backhoe.odometry.squares import Umbmark, square, umbmark, umbmark_exact
from backhoe.odometry.sums import bilinear_sum, euler_sum
from backhoe.odometry.tracked import Wheels, from_angles, track_twist

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
    "integrate_body",
    "intervals",
    "mecanum",
    "omni",
    "order",
    "relative",
    "se2_exp",
    "se2_log",
    "se2_matrix",
    "square",
    "streaming",
    "track_twist",
    "tracks",
    "umbmark",
    "umbmark_exact",
    "winding",
]
