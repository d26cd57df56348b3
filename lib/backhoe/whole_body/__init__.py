"""Tracks and arm together: how the hand moves, and velocities that move it as wanted.

- `robots`: the robot of the slides and the backhoe, their hands and Jacobians
- `linear`: minimum norm, null space, manipulability; `priorities`: several tasks, the first first
- `tracking`: the wanted velocity of the hand; `limits`: velocities within limits
- `loops`: the solution of J v = b, written once; `engine`: the same, compiled
- `stability`: what keeps the machine on its tracks, and how much of a load tips it over

Source: Sasig and Chicaiza 2017; Mastalli 2013 for the balance.
"""

from backhoe.whole_body.limits import Limited, joint_bounds, limited_velocity
from backhoe.whole_body.linear import (
    damping_near_singularity,
    manipulability,
    manipulability_gradient,
    minimum_norm,
    null_projector,
)
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
from backhoe.whole_body.tracking import wanted_velocity

__all__ = [
    "BACKHOE",
    "SLIDES",
    "Excavator",
    "Limited",
    "Robot",
    "SlidesRobot",
    "damping_near_singularity",
    "hand",
    "jacobian",
    "joint_bounds",
    "limited_velocity",
    "manipulability",
    "manipulability_gradient",
    "minimum_norm",
    "null_projector",
    "strict_priorities",
    "wanted_velocity",
]
