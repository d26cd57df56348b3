"""Kinematics of the arm, forwards and backwards.

- `forward`: Denavit-Hartenberg transforms, the pose of every frame, the Jacobian
- `inverse`: joint angles for a pose, in closed form
- `damped`: joint angles for a pose by damped least squares, for singular places
"""

from backhoe.arm.kinematics.damped import (
    DampedSolution,
    adaptive_damping,
    damped_inverse,
    solve_damped,
    task_jacobian,
)
from backhoe.arm.kinematics.forward import (
    FRAMES,
    dh_transform,
    forward_kinematics,
    jacobian,
    joint_vector,
    link_transforms,
    pose,
)
from backhoe.arm.kinematics.inverse import inverse_kinematics

__all__ = [
    "FRAMES",
    "DampedSolution",
    "adaptive_damping",
    "damped_inverse",
    "dh_transform",
    "forward_kinematics",
    "inverse_kinematics",
    "jacobian",
    "joint_vector",
    "link_transforms",
    "pose",
    "solve_damped",
    "task_jacobian",
]
