"""Kinematics of the machine: the arm forwards, backwards and by damped least squares; the tracks.

- `forward`: Denavit-Hartenberg transforms, the pose of every frame, the Jacobian
- `inverse`: joint angles for a pose, in closed form
"""

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

__all__ = [
    "FRAMES",
    "dh_transform",
    "forward_kinematics",
    "inverse_kinematics",
    "inverse_tip",
    "jacobian",
    "joint_vector",
    "link_transforms",
    "pose",
]
