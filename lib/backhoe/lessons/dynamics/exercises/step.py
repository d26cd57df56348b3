"""Exercise 2.8: one step of an integrator."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics
from backhoe.lessons.dynamics.exercises.postures import postures
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE


def semi_implicit_step(q: ArrayLike, dq: ArrayLike, tau: ArrayLike, dt: float) -> NDArray:
    """One step of semi-implicit Euler: the new angles and, below them, the new speeds, (2, 4)."""
    dq_new = dq + dt * dynamics.forward_dynamics(q, dq, tau)
    q_new = q + dt * dq_new
    return np.array([q_new, dq_new])


def _step_cases(rng: np.random.Generator) -> list[tuple]:
    dq, share = rng.uniform(-1, 1, (2, 30, 4))
    tau = share * BACKHOE.torque_limit
    return list(zip(postures(rng, 30), dq, tau, rng.uniform(0.005, 0.05, 30), strict=True))


def _moved_by(old: float, new: float) -> object:
    """The step whose angle moves with these shares of the old and the new speed, times dt."""

    def step(q: ArrayLike, dq: ArrayLike, tau: ArrayLike, dt: float) -> NDArray:
        dq_new = semi_implicit_step(q, dq, tau, dt)[1]
        return np.array([q + dt * (old * dq + new * dq_new), dq_new])

    return step


def _position_first(q: ArrayLike, dq: ArrayLike, tau: ArrayLike, dt: float) -> NDArray:
    q_new = q + dt * dq
    return np.array([q_new, semi_implicit_step(q_new, dq, tau, dt)[1]])


def _accelerated(q: ArrayLike, dq: ArrayLike, dt: float, ddq: NDArray) -> NDArray:
    """The step with another acceleration."""
    dq_new = dq + dt * ddq
    return np.array([q + dt * dq_new, dq_new])


STEP = Exercise(
    number="2.8",
    title="one step of semi-implicit Euler",
    reference=semi_implicit_step,
    oracle="speed_first_by_inverse_dynamics",
    cases=_step_cases,
    tested_on="30 random states and steps",
    hints=(
        "first the new speed from the acceleration, then the new angle from the new speed",
        "ddq = dynamics.forward_dynamics(q, dq, tau); return np.array([q_new, dq_new])",
    ),
    mistakes={
        "that is explicit Euler: the new angle must use the new speed": _moved_by(1, 0),
        "that is the other semi-implicit Euler, angle first: here the speed goes first": (
            _position_first
        ),
        "the angle moves with the new speed alone, not with the mean of old and new": (
            _moved_by(1 / 2, 1 / 2)
        ),
        "the angle needs the step as well: q + dt * dq_new": (
            lambda q, dq, tau, dt: semi_implicit_step(q, dq, tau, dt)[[1, 1]] + np.array([q, 0 * q])
        ),
        "both lines need the step: dt times the speed, dt times the acceleration": (
            lambda q, dq, tau, dt: semi_implicit_step(q, dq, tau, 1.0)
        ),
        "a torque is no acceleration: divide by M, forward_dynamics does it": (
            lambda q, dq, tau, dt: _accelerated(q, dq, dt, tau)
        ),
        "inverse_dynamics gives torques: the acceleration comes from forward_dynamics": (
            lambda q, dq, tau, dt: _accelerated(q, dq, dt, dynamics.inverse_dynamics(q, dq, tau))
        ),
        "M ddq = tau is not the whole equation: forward_dynamics has C dq and g, too": (
            lambda q, dq, tau, dt: _accelerated(
                q, dq, dt, np.linalg.solve(dynamics.mass_matrix(q), tau)
            )
        ),
        "the torques are missing: hand tau on to forward_dynamics": (
            lambda q, dq, tau, dt: semi_implicit_step(q, dq, 0 * np.asarray(tau), dt)
        ),
        "the arm moves already: hand dq on to forward_dynamics, C dq is in it": (
            lambda q, dq, tau, dt: _accelerated(
                q, dq, dt, dynamics.forward_dynamics(q, 0 * np.asarray(dq), tau)
            )
        ),
        "no friction was asked for": (
            lambda q, dq, tau, dt: _accelerated(
                q, dq, dt, dynamics.forward_dynamics(q, dq, tau, True)
            )
        ),
        "that is the acceleration in the second row: return the new speed": (
            lambda q, dq, tau, dt: np.array(
                [semi_implicit_step(q, dq, tau, dt)[0], dynamics.forward_dynamics(q, dq, tau)]
            )
        ),
        "those are the changes: add them to q and dq": (
            lambda q, dq, tau, dt: semi_implicit_step(q, dq, tau, dt) - np.array([q, dq])
        ),
        "the angle moves with the new speed, dq included": (
            lambda q, dq, tau, dt: (
                semi_implicit_step(q, dq, tau, dt)
                - np.array([dt * np.asarray(dq), 0 * np.asarray(dq)])
            )
        ),
        "the speed does not change in your step: add dt times the acceleration": (
            lambda q, dq, tau, dt: _accelerated(q, dq, dt, 0 * np.asarray(dq))
        ),
        "the order: return the angles first, then the speeds": (
            lambda q, dq, tau, dt: semi_implicit_step(q, dq, tau, dt)[::-1]
        ),
        "time runs backwards: check the signs before dt": (
            lambda q, dq, tau, dt: semi_implicit_step(q, dq, tau, -dt)
        ),
        "gravity is missing from the acceleration: use forward_dynamics, which has it": (
            lambda q, dq, tau, dt: semi_implicit_step(q, dq, tau + dynamics.gravity_torque(q), dt)
        ),
    },
)
