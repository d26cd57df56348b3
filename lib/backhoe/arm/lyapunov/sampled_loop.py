"""What a sampled controller can bear: the torque is held for dt while the arm moves on.

A derivative gain of about 2 J/dt turns the speed of an inertia J round in one sample, and anything
above makes it grow; J is the joint's effective inertia, 1/(M^-1)_jj, with all other joints free.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.dynamics import mass_matrix
from backhoe.arm.kinematics import joint_vector
from backhoe.arm.lyapunov.extremes import gravity_slope
from backhoe.arm.lyapunov.gains import gain_matrices
from backhoe.arm.lyapunov.suprema import domain_of, supremum
from backhoe.arm.pid import Gains
from backhoe.basics.inputs import positive
from backhoe.machine import BACKHOE, Machine

_SERIES = 8


def effective_inertia(
    q: ArrayLike | None = None, *, domain: str = "box", machine: Machine = BACKHOE
) -> NDArray:
    """Inertia that each joint's drive feels while all other joints are free.

    Args:
        q: postures, shape (..., 4) [rad]; None for the smallest values over a whole domain.
        domain: "box" or "torus", when q is None.

    Returns:
        1/(M^-1)_jj, shape (..., 4) for postures, (4,) for a domain [kg m^2].

    Raises:
        ValueError: q does not end in 4 joints or is not finite; an unknown domain.
    """

    def lightness(q: NDArray) -> NDArray:
        return np.diagonal(np.linalg.inv(mass_matrix(q, machine)), axis1=-2, axis2=-1)

    if q is not None:
        return 1 / lightness(joint_vector(q))
    where = domain_of(None, domain, machine)
    tops = (supremum(lambda q, j=j: lightness(q)[:, j], where) for j in range(4))
    return np.array([1 / top.value for top in tops])


def sampled_radius(
    gains: Gains, q: ArrayLike, dt: float = 0.001, *, machine: Machine = BACKHOE
) -> NDArray:
    """Spectral radius of the sampled closed loop near postures: below 1 it is stable there.

    The arm is linearised at rest, M ddx + dg/dq x = torque, and solved exactly while the torque
    of `pid.PID` is held: tau = - K_p x - K_d dx - K_i s, s' = s + dt x, of the present sample.

    Args:
        gains: each (4,) or symmetric (4, 4) [N m/rad, N m/(rad s), N m s/rad].
        q: postures, shape (..., 4) [rad].
        dt: time for which a torque is held [s].

    Returns:
        Largest absolute eigenvalue from one sample to the next, shape (...).

    Raises:
        ValueError: a gain is not positive definite, dt not positive, q not (..., 4) and finite.
    """
    Kp, Ki, Kd = gain_matrices(gains)
    q, dt = joint_vector(q), positive(dt, "dt", "s")
    M, H = mass_matrix(q, machine), gravity_slope(q, machine=machine)
    flow, push = _held(M, H, dt)
    step = np.zeros((*q.shape[:-1], 12, 12))
    step[..., :8, :8] = flow - push @ np.hstack([Kp + dt * Ki, Kd])
    step[..., :8, 8:] = -push @ Ki
    step[..., 8:, :4] = dt * np.eye(4)
    step[..., 8:, 8:] = np.eye(4)
    return np.abs(np.linalg.eigvals(step)).max(axis=-1)


def _held(M: NDArray, H: NDArray, dt: float) -> tuple[NDArray, NDArray]:
    """How (x, dx) goes on in dt by itself (..., 8, 8), and by a torque held (..., 8, 4).

    By the series of the matrix exponential: dt is small beside the arm's slowest swing.
    """
    rate = np.zeros((*M.shape[:-2], 12, 12))
    rate[..., :4, 4:8] = np.eye(4)
    rate[..., 4:8, :4] = -np.linalg.solve(M, H)
    rate[..., 4:8, 8:] = np.linalg.inv(M)
    flow = term = np.broadcast_to(np.eye(12), rate.shape)
    for order in range(1, _SERIES + 1):
        term = term @ rate * (dt / order)
        flow = flow + term
    return flow[..., :8, :8], flow[..., :8, 8:]
