"""The simulation without PyBullet: the exact equations of motion, written out.

The arm's M, C and g are those of `backhoe.dynamics`. On tracks, the vehicle's x, y and yaw join the
four joints; house and arm and vehicle push each other in full. There are no contacts, except that
the tracks rest on the ground and the bucket digs, and no cameras.

Derivation. Let p be the point where the swing axis stands, w = (yaw rate + swing rate, boom, stick,
bucket rates), m the mass of house and arm and m s(q) its first moment about p in the world's plane.
Then with K = d(m s)/d(swing, boom, stick, bucket)

    m p'' + K w' + K' w = force on p,    M w' + C w + g + K^T p'' = joint torques.

In K the outward moment of the arm is g_2 over gravity, and its derivatives are the gravity torques
of the arm turned by 90 degrees, over gravity: nothing has to be derived twice.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from backhoe import dynamics
from backhoe.sim.loop import Loop
from backhoe.sim.urdf import undercarriage_inertia

_BOOM_UP = np.array([0.0, pi / 2, 0.0, 0.0])
_LATER = np.maximum.outer(np.arange(1, 4), np.arange(1, 4))


class AnalyticWorld(Loop):
    """A `Loop` that integrates the exact dynamics by semi-implicit Euler; arguments as there."""

    backend = "analytic"

    def _integrate(self, pushed: NDArray) -> None:
        if self.base == "fixed":
            ddq = np.zeros(7)
            ddq[3:] = dynamics.forward_dynamics(
                self._q[3:], self._dq[3:], pushed[3:], machine=self._loaded
            )
        else:
            ddq = self._acceleration(pushed)
        self._dq = self._dq + self.dt * ddq
        self._q = self._q + self.dt * self._dq

    def _carry(self, payload: float) -> None:
        bucket = self.machine.bucket
        self._loaded = replace(self.machine, bucket=replace(bucket, mass=bucket.mass + payload))
        self._light = replace(self._loaded, gravity=1.0)

    def _acceleration(self, pushed: NDArray) -> NDArray:
        """Accelerations of x, y, yaw and the joints, shape (7,)."""
        machine, q = self._loaded, self._q[3:]
        yaw, yaw_rate = self._q[2], self._dq[2]
        w = self._dq[3:].copy()
        w[0] += yaw_rate
        moment, slope, bend = self._first_moment(q)
        house = machine.swing.mass * machine.swing.com_radius
        left = house * sin(machine.swing.com_angle)
        heading = yaw + q[0] + pi / 2
        outward = np.array([cos(heading), sin(heading)])
        leftward = np.array([-outward[1], outward[0]])
        K = np.empty((2, 4))
        K[:, 0] = moment * leftward - left * outward
        K[:, 1:] = np.outer(outward, slope)
        swept = 2 * w[0] * (slope @ w[1:])
        dK_w = (w[1:] @ bend @ w[1:] - w[0] ** 2 * moment) * outward + (
            swept - w[0] ** 2 * left
        ) * leftward
        house_and_arm = machine.mass - machine.tracks.mass
        H = np.zeros((6, 6))
        H[0, 0] = H[1, 1] = house_and_arm
        H[:2, 2:], H[2:, :2] = K, K.T
        H[2:, 2:] = dynamics.mass_matrix(q, machine)
        bias = np.concatenate([dK_w, dynamics.inverse_dynamics(q, w, np.zeros(4), machine=machine)])

        offset = machine.base.offset
        to_axis = offset * np.array([cos(yaw), sin(yaw)])
        B = np.zeros((6, 7))
        B[0, 0] = B[1, 1] = B[2, 2] = 1.0
        B[0, 2], B[1, 2] = -to_axis[1], to_axis[0]
        B[2:, 3:] = np.eye(4)
        bias -= H[:, :2] @ (yaw_rate**2 * to_axis)
        M = B.T @ H @ B
        M[0, 0] += machine.tracks.mass
        M[1, 1] += machine.tracks.mass
        M[2, 2] += undercarriage_inertia(machine)
        return np.linalg.solve(M, pushed - B.T @ bias)

    def _first_moment(self, q: NDArray) -> tuple[float, NDArray, NDArray]:
        """Outward first moment of house and arm about the swing axis, [kg m].

        Returns:
            Its value, its derivatives by boom, stick and bucket, shape (3,), and its second
            derivatives, shape (3, 3).
        """
        machine = self._loaded
        swing = machine.swing
        reach = dynamics.gravity_torque(q, self._light)
        slope = dynamics.gravity_torque(q + _BOOM_UP, self._light)
        arm = machine.boom.mass + machine.stick.mass + machine.bucket.mass
        moment = (
            reach[1] + arm * swing.offset + swing.mass * swing.com_radius * cos(swing.com_angle)
        )
        return moment, slope[1:], -reach[_LATER]
