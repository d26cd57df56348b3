"""Kinematics of the machine: the arm, forwards and backwards, and the tracks.

- `forward`: Denavit-Hartenberg transforms, the pose of every frame, the Jacobian
- `inverse`: joint angles for a pose, in closed form
- `damped`: joint angles for a pose by damped least squares, for singular places
- `tracks`: sprocket speeds and the motion of the machine
"""

from backhoe.kinematics.damped import (
    DampedSolution,
    adaptive_damping,
    damped_inverse,
    solve_damped,
    task_jacobian,
)
from backhoe.kinematics.forward import (
    FRAMES,
    dh_transform,
    forward_kinematics,
    jacobian,
    joint_vector,
    link_transforms,
    pose,
)
from backhoe.kinematics.inverse import inverse_kinematics, inverse_tip
from backhoe.kinematics.tracks import (
    sprocket_speeds,
    tracks_twist,
    twist_to_world,
    world_rates,
)

__all__ = [
    "FRAMES",
    "DampedSolution",
    "adaptive_damping",
    "damped_inverse",
    "dh_transform",
    "forward_kinematics",
    "inverse_kinematics",
    "inverse_tip",
    "jacobian",
    "joint_vector",
    "link_transforms",
    "pose",
    "solve_damped",
    "sprocket_speeds",
    "task_jacobian",
    "tracks_twist",
    "twist_to_world",
    "world_rates",
]
