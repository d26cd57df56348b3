"""Tracks and arm together: how the hand moves, and velocities that move it as wanted.

- `robots`: the robot of the slides and the backhoe, their hands and Jacobians
- `linear`: minimum norm, null space; `priorities`: several tasks, the first first
- `manipulability`: how easily the hand moves
- `secondary`: what the null space is for: posture, manipulability, joint limits
- `obstacles`: how far platform and arm are from them, and how to keep clear
- `tracking`: the wanted velocity of the hand; `limits`: velocities within limits; `rows`: those
  of belts and balance
- `plant`: a robot that only moves; `paths`: for its hand; `following`: one along the other
- `loops`: the solution of J v = b, written once; `engine`: the same, compiled
- `stability`: what keeps the machine on its tracks, and how much of a load tips it over

Source: Sasig and Chicaiza 2017; Mastalli 2013 for the balance.
"""

from backhoe.whole_body.following import Following, follow
from backhoe.whole_body.limits import Limited, joint_bounds, limited_velocity
from backhoe.whole_body.linear import damping_near_singularity, minimum_norm, null_projector
from backhoe.whole_body.manipulability import (
    Ellipsoid,
    characteristic_length,
    ellipsoid,
    length_weights,
    manipulability,
    manipulability_gradient,
)
from backhoe.whole_body.obstacles import Clearance, clearance, keep_clear, steer_clear
from backhoe.whole_body.paths import HandPath, circle_path, eight_path, sine_path
from backhoe.whole_body.plant import KinematicPlant
from backhoe.whole_body.priorities import strict_priorities
from backhoe.whole_body.robots import (
    BACKHOE,
    SLIDES,
    Excavator,
    Robot,
    SlidesRobot,
    hand,
    jacobian,
)
from backhoe.whole_body.rows import Rows, margin_rows, track_rows
from backhoe.whole_body.secondary import from_limits, to_manipulability, to_posture
from backhoe.whole_body.tracking import wanted_velocity

__all__ = [
    "BACKHOE",
    "SLIDES",
    "Clearance",
    "Ellipsoid",
    "Excavator",
    "Following",
    "HandPath",
    "KinematicPlant",
    "Limited",
    "Robot",
    "Rows",
    "SlidesRobot",
    "characteristic_length",
    "circle_path",
    "clearance",
    "damping_near_singularity",
    "eight_path",
    "ellipsoid",
    "follow",
    "from_limits",
    "hand",
    "jacobian",
    "joint_bounds",
    "keep_clear",
    "length_weights",
    "limited_velocity",
    "manipulability",
    "manipulability_gradient",
    "margin_rows",
    "minimum_norm",
    "null_projector",
    "sine_path",
    "steer_clear",
    "strict_priorities",
    "to_manipulability",
    "to_posture",
    "track_rows",
    "wanted_velocity",
]
