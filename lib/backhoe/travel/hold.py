"""The torque that holds the arm still while the machine travels.

Imported on first use: Numba takes half a second to load.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from backhoe import pid
from backhoe.dynamics import terms
from backhoe.kinematics import joint_vector
from backhoe.machine import BACKHOE, Machine
from backhoe.travel.posture import POSTURE

__all__ = ["Hold"]

_vectors = njit(terms.vectors)
_gravity_torques = njit(terms.gravity_torques)


class Hold:
    """The torque that keeps the arm where it is: gravity compensation and a PD, compiled.

    Args:
        q: joint angles to keep, shape (4,) [rad].
        machine: whose arm.

    Raises:
        ValueError: q is not 4 finite angles.
    """

    def __init__(self, q: ArrayLike = POSTURE, machine: Machine = BACKHOE) -> None:
        self.q = joint_vector(q).copy()
        if self.q.shape != (4,):
            raise ValueError(f"q must be 4 joint angles, got shape {self.q.shape}")
        self._arm = terms.arm_of(machine)
        self._kp, self._kd = np.array(pid.ARM_GAINS.kp), np.array(pid.ARM_GAINS.kd)

    def __call__(self, q: NDArray, dq: NDArray) -> NDArray:
        """Joint torques, shape (4,) [N m], for angles and speeds of shape (4,) [rad, rad/s]."""
        return _hold(self._arm, self.q, self._kp, self._kd, q, dq)


@njit(cache=True)
def _hold(arm, q_ref, kp, kd, q, dq):
    p2 = q[1] + arm.o2
    p3 = p2 + q[2] + arm.o3
    p4 = p3 + q[3] + arm.o4
    v = _vectors(arm, np.cos(p2), np.sin(p2), np.cos(p3), np.sin(p3), np.cos(p4), np.sin(p4))
    torque = kp * (q_ref - q) - kd * dq
    g2, g3, g4 = _gravity_torques(arm, v)
    torque[1] += g2
    torque[2] += g3
    torque[3] += g4
    return torque
