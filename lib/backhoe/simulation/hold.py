"""The torque that holds the arm still while the machine travels."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics, pid
from backhoe.basics.inputs import numbers
from backhoe.machine import BACKHOE, Machine
from backhoe.vehicle.travel.posture import POSTURE


class Hold:
    """The torque that keeps the arm where it is: the posture's gravity torque and a PD.

    Args:
        q: joint angles to keep, shape (4,) [rad].
        machine: whose arm.

    Raises:
        ValueError: q is not 4 finite angles.
    """

    def __init__(self, q: ArrayLike = POSTURE, machine: Machine = BACKHOE) -> None:
        self.q = numbers(q, "q", (4,), meaning="joints (swing, boom, stick, bucket)").copy()
        self._kp, self._kd = np.array(pid.ARM_GAINS.kp), np.array(pid.ARM_GAINS.kd)
        self._start = dynamics.gravity_torque(self.q, machine) + self._kp * self.q

    def __call__(self, q: NDArray, dq: NDArray) -> NDArray:
        """Joint torques, shape (4,) [N m], for angles and speeds of shape (4,) [rad, rad/s]."""
        return self._start - self._kp * q - self._kd * dq
