"""Joint PID control: one proportional, integral and derivative gain for each joint.

The law is eq. (3.1) of Mastalli 2013, tau = K_p e + K_i int e + K_d de/dt, with e = q_ref - q and
the derivative taken from measured joint speeds. Lesson 03 derives the gains; those of `ARM_GAINS`
are ours, chosen for the tour with `gravity_torque` added to the PID.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive


class Gains(NamedTuple):
    """Gains of the four joints: kp [N m/rad], ki [N m/(rad s)], kd [N m s/rad], shape (4,) each.

    Batches of runs have shape (n, 4) each, the analysis of stability also takes matrices (4, 4).
    """

    kp: ArrayLike
    ki: ArrayLike
    kd: ArrayLike


ARM_GAINS = Gains(
    kp=(3.0e6, 4.0e6, 1.0e6, 3.0e5),
    ki=(4.0e5, 6.0e5, 2.0e5, 6.0e4),
    kd=(7.0e5, 9.0e5, 1.2e5, 2.5e4),
)


class PID:
    """A PID for n joints whose integral stops while the torque is at its limit.

    Args:
        kp, ki, kd: gains, shape (n,) [N m/rad, N m/(rad s), N m s/rad].
        torque_limit: largest torque of each joint, shape (n,) [N m], or None for no limit.

    Raises:
        ValueError: gains of different shape, negative, or not finite; a limit that is not positive.
    """

    def __init__(
        self,
        kp: ArrayLike,
        ki: ArrayLike,
        kd: ArrayLike,
        torque_limit: ArrayLike | None = None,
    ) -> None:
        self.kp = numbers(kp, "kp", ("n",), meaning="gains, one for each joint")
        self.ki, self.kd = numbers(ki, "ki", self.kp.shape), numbers(kd, "kd", self.kp.shape)
        for name in ("kp", "ki", "kd"):
            if (getattr(self, name) < 0).any():
                raise ValueError(f"{name} must not be negative, got {getattr(self, name)}")
        limit = np.full_like(self.kp, np.inf) if torque_limit is None else torque_limit
        self.torque_limit = numbers(limit, "torque_limit", self.kp.shape, finite=False)
        if not (self.torque_limit > 0).all():
            raise ValueError(f"torque_limit must be above 0 N m, got {torque_limit}")
        self.reset()

    def reset(self) -> None:
        """Forget the integral of the error."""
        self.integral = [0.0] * len(self.kp)

    def __call__(
        self, q_ref: NDArray, dq_ref: NDArray, q: NDArray, dq: NDArray, dt: float
    ) -> NDArray:
        """Torque for one sample.

        Args:
            q_ref, dq_ref: where the joints should be, shape (n,) [rad, rad/s].
            q, dq: where they are, shape (n,) [rad, rad/s].
            dt: time since the last call [s].

        Returns:
            Joint torques, shape (n,) [N m], within the torque limit.

        Raises:
            ValueError: another shape, a value that is not finite, or dt is not positive; the PID
                is as before then.
        """
        errors = numbers(q_ref - q, "q_ref - q", self.kp.shape)
        rates = numbers(dq_ref - dq, "dq_ref - dq", self.kp.shape)
        positive(dt, "dt", "s")
        joints = self.kp, self.ki, self.kd, self.torque_limit, errors, rates
        columns = zip(*(values.tolist() for values in joints), strict=True)
        torque = []
        for joint, (kp, ki, kd, limit, error, rate) in enumerate(columns):
            integral = self.integral[joint] + error * dt
            wanted = kp * error + ki * integral + kd * rate
            applied = min(max(wanted, -limit), limit)
            if applied == wanted or wanted * error <= 0:
                self.integral[joint] = integral
            torque.append(applied)
        return np.array(torque)
