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
    return [
        (q, dq, tau, dt)
        for q, dq, tau, dt in zip(
            postures(rng, 30),
            rng.uniform(-1, 1, (30, 4)),
            rng.uniform(-1, 1, (30, 4)) * BACKHOE.torque_limit,
            rng.uniform(0.005, 0.05, 30),
            strict=True,
        )
    ]


def _explicit_step(q: ArrayLike, dq: ArrayLike, tau: ArrayLike, dt: float) -> NDArray:
    return np.array([q + dt * dq, semi_implicit_step(q, dq, tau, dt)[1]])


def _position_first(q: ArrayLike, dq: ArrayLike, tau: ArrayLike, dt: float) -> NDArray:
    q_new = q + dt * dq
    return np.array([q_new, dq + dt * dynamics.forward_dynamics(q_new, dq, tau)])


def _taylor_step(q: ArrayLike, dq: ArrayLike, tau: ArrayLike, dt: float) -> NDArray:
    dq_new = semi_implicit_step(q, dq, tau, dt)[1]
    return np.array([q + dt * (dq + dq_new) / 2, dq_new])


def _without_gravity(q: ArrayLike, dq: ArrayLike, tau: ArrayLike, dt: float) -> NDArray:
    return semi_implicit_step(q, dq, tau + dynamics.gravity_torque(q), dt)


STEP = Exercise(
    number="2.8",
    title="one step of semi-implicit Euler",
    reference=semi_implicit_step,
    cases=_step_cases,
    tested_on="30 random states and steps",
    hints=(
        "first the new speed from the acceleration, then the new angle from the new speed",
        "ddq = dynamics.forward_dynamics(q, dq, tau); return np.array([q_new, dq_new])",
    ),
    mistakes={
        "that is explicit Euler: the new angle must use the new speed": _explicit_step,
        "that is the other semi-implicit Euler, angle first: here the speed goes first": (
            _position_first
        ),
        "the angle moves with the new speed alone, not with the mean of old and new": (
            _taylor_step
        ),
        "the angle needs the step as well: q + dt * dq_new": (
            lambda q, dq, tau, dt: np.array(
                [q + semi_implicit_step(q, dq, tau, dt)[1], semi_implicit_step(q, dq, tau, dt)[1]]
            )
        ),
        "the order: return the angles first, then the speeds": (
            lambda q, dq, tau, dt: semi_implicit_step(q, dq, tau, dt)[::-1]
        ),
        "time runs backwards: check the signs before dt": (
            lambda q, dq, tau, dt: semi_implicit_step(q, dq, tau, -dt)
        ),
        "gravity is missing from the acceleration: use forward_dynamics, which has it": (
            _without_gravity
        ),
    },
)
