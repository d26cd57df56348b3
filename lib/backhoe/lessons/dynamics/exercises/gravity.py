"""Exercises 2.1, 2.2 and 2.5: weights, forces and their torques."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics, kinematics
from backhoe.lessons.dynamics import printed
from backhoe.lessons.dynamics.exercises.postures import RADIANS, postures, variant
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE


def boom_acceleration(angle: float) -> float:
    """Acceleration of the boom alone, from rest [rad/s^2], at the joint angle `angle` [rad]."""
    boom = BACKHOE.boom
    weight_torque = boom.mass * BACKHOE.gravity * boom.com_radius * np.cos(angle + boom.com_angle)
    return -weight_torque / (boom.inertia + boom.mass * boom.com_radius**2)


def _boom(angle: float, *, inertia: float | None = None, radius: float | None = None) -> float:
    boom = BACKHOE.boom
    radius = boom.com_radius if radius is None else radius
    inertia = boom.inertia + boom.mass * radius**2 if inertia is None else inertia
    return -boom.mass * BACKHOE.gravity * radius * np.cos(angle + boom.com_angle) / inertia


BOOM_ALONE = Exercise(
    number="2.1",
    title="the boom alone, let go",
    reference=boom_acceleration,
    cases=lambda rng: [(angle,) for angle in rng.uniform(-0.9, 1.0, 50)],
    tested_on="50 angles",
    hints=(
        "write K and U with one angle, then let Lagrange's equation do the rest",
        "K = (m L_cm^2 + I) dq^2 / 2 and U = m g L_cm sin(q + theta_cm); tau is zero",
    ),
    mistakes={
        "the sign: an outstretched boom that you let go must fall, so a negative acceleration": (
            lambda angle: -boom_acceleration(angle)
        ),
        "the boom turns about its joint: to I add m L_cm^2 (Steiner)": (
            lambda angle: _boom(angle, inertia=BACKHOE.boom.inertia)
        ),
        "a boom is not a point mass: its own inertia I belongs beside m L_cm^2": (
            lambda angle: _boom(angle, inertia=BACKHOE.boom.mass * BACKHOE.boom.com_radius**2)
        ),
        "the weight pulls at the centre of mass, L_cm from the joint, not at the boom's tip": (
            lambda angle: _boom(angle, radius=BACKHOE.boom.length)
        ),
        "theta_2 points at the boom's tip; the centre of mass lies at theta_cm2": (
            lambda angle: boom_acceleration(
                angle + BACKHOE.boom.angle_offset - BACKHOE.boom.com_angle
            )
        ),
        "q is not yet the angle above the horizontal: add theta_cm2": (
            lambda angle: boom_acceleration(angle - BACKHOE.boom.com_angle)
        ),
        "the lever arm of a weight is horizontal: the cosine of the angle, not its sine": (
            lambda angle: boom_acceleration(angle - np.pi / 2)
        ),
        "a factor 2: the 1/2 of the kinetic energy goes when you differentiate by the speed": (
            lambda angle: boom_acceleration(angle) / 2
        ),
        "a factor 2: differentiate dq^2 / 2 by dq once more": (
            lambda angle: 2 * boom_acceleration(angle)
        ),
        (RADIANS): (lambda angle: boom_acceleration(np.radians(angle))),
    },
)


def _own_weight(q: ArrayLike) -> NDArray:
    g = dynamics.gravity_torque(q)
    massless = {"mass": 1e-12}
    boom = dynamics.gravity_torque(q, variant(stick=massless, bucket=massless))[1]
    stick = dynamics.gravity_torque(q, variant(bucket=massless))[2]
    return np.array([0.0, boom, stick, g[3]])


def _hung_at_the_joint(q: ArrayLike) -> NDArray:
    _, boom, stick, bucket = _own_weight(q)
    return np.array([0.0, boom + stick + bucket, stick + bucket, bucket])


def _own_angles(q: ArrayLike) -> NDArray:
    masses = np.array([link.mass for link in BACKHOE.links])
    beyond = np.append(np.cumsum(masses[::-1])[::-1][1:], 0.0)
    g = np.zeros(4)
    for k, link in enumerate(BACKHOE.links):
        g[k + 1] = masses[k] * link.com_radius * np.cos(q[k + 1] + link.com_angle)
        g[k + 1] += beyond[k] * link.length * np.cos(q[k + 1] + link.angle_offset)
    return BACKHOE.gravity * np.array([0.0, g[1] + g[2] + g[3], g[2] + g[3], g[3]])


GRAVITY = Exercise(
    number="2.2",
    title="the torque that holds the arm",
    reference=dynamics.gravity_torque,
    cases=lambda rng: [(q,) for q in postures(rng, 200)],
    tested_on="200 random postures",
    hints=(
        "start at the bucket: g4 is the bucket's weight times its horizontal lever arm",
        "g3 = g4 + what the stick adds: its own weight, and the bucket's weight at the stick's tip",
    ),
    mistakes={
        "the sign: g holds the arm up, so an outstretched boom needs a positive g2": (
            lambda q: -dynamics.gravity_torque(q)
        ),
        "that is (2.21) as printed: look for a length without its cosine and a missing weight": (
            printed.gravity_torque
        ),
        "the bucket is missing: its weight pulls at all three joints": (
            lambda q: dynamics.gravity_torque(q, machine=variant(bucket={"mass": 1e-12}))
        ),
        "a link's own weight pulls at its centre of mass, L_cm from its joint, not at its end": (
            lambda q: dynamics.gravity_torque(
                q,
                machine=variant(
                    **{
                        name: {"com_radius": getattr(BACKHOE, name).length}
                        for name in ("boom", "stick", "bucket")
                    }
                ),
            )
        ),
        "a joint carries every link beyond it, not only its own": _own_weight,
        "stick and bucket hang at the boom's tip: (m_s + m_bu) L2 cos q2* is missing": (
            _hung_at_the_joint
        ),
        "a weight's lever arm needs the absolute angle of its link: q2* + q3cm, not q3cm alone": (
            _own_angles
        ),
        "the last angle in each term is that of the centre of mass, com_angle": (
            partial(
                dynamics.gravity_torque,
                machine=variant(
                    **{
                        name: {"com_angle": getattr(BACKHOE, name).angle_offset}
                        for name in ("boom", "stick", "bucket")
                    }
                ),
            )
        ),
        "the lever arm of a weight is horizontal: cosines, not sines": (
            lambda q: dynamics.gravity_torque(q - np.array([0.0, np.pi / 2, 0.0, 0.0]))
        ),
        "a factor 9.81: a weight is m g": lambda q: dynamics.gravity_torque(q) / BACKHOE.gravity,
        "a factor 1000: give N m, not kN m": lambda q: dynamics.gravity_torque(q) / 1e3,
        (RADIANS): (lambda q: dynamics.gravity_torque(np.radians(q))),
    },
)


def holding_torque(q: ArrayLike, tip_force: ArrayLike) -> NDArray:
    """Torque [N m] that holds the arm still while its tip exerts `tip_force` [N], base frame."""
    return dynamics.inverse_dynamics(q, np.zeros(4), np.zeros(4), tip_force=tip_force)


def _tip_torque(q: ArrayLike, force: ArrayLike, frame: str = "tip") -> NDArray:
    return kinematics.jacobian(q, frame)[:3].T @ force


def _in_the_tip_frame(q: ArrayLike, force: ArrayLike) -> NDArray:
    R = kinematics.forward_kinematics(q)[:3, :3]
    return dynamics.gravity_torque(q) + _tip_torque(q, R @ force)


def _as_moment(q: ArrayLike, force: ArrayLike) -> NDArray:
    return dynamics.gravity_torque(q) + kinematics.jacobian(q)[3:].T @ force


def _upwards_only(q: ArrayLike, force: ArrayLike) -> NDArray:
    return dynamics.gravity_torque(q) + _tip_torque(q, np.array([0.0, 0.0, force[2]]))


def _own_joint_only(q: ArrayLike, force: ArrayLike) -> NDArray:
    torque = dynamics.gravity_torque(q)
    torque[3] += _tip_torque(q, force)[3]
    return torque


HOLD = Exercise(
    number="2.5",
    title="hold still while the teeth push",
    reference=holding_torque,
    cases=lambda rng: list(zip(postures(rng, 100), rng.uniform(-3e4, 3e4, (100, 3)), strict=True)),
    tested_on="100 random postures and forces",
    hints=(
        "two torques: what gravity asks for, and what the force asks for",
        "a force F at a point with velocity J dq needs the torque J^T F: only the linear rows of J",
    ),
    mistakes={
        "the sign of the force: h_e is what the teeth exert, so J^T h_e adds to the torque": (
            lambda q, force: dynamics.gravity_torque(q) - _tip_torque(q, force)
        ),
        "the force changes nothing in your function: add J^T times it": (
            lambda q, force: dynamics.gravity_torque(q)
        ),
        "the arm is heavy: add the gravity torque": _tip_torque,
        "the sign of gravity: the torque holds the arm up, so + g": (
            lambda q, force: _tip_torque(q, force) - dynamics.gravity_torque(q)
        ),
        ('the teeth are the frame "tip"; "stick" is the bucket\'s pin'): (
            lambda q, force: dynamics.gravity_torque(q) + _tip_torque(q, force, "stick")
        ),
        "the force is given in the base frame already: do not turn it": _in_the_tip_frame,
        "those are the angular rows of J, for moments: a force takes the first three": _as_moment,
        "only the vertical part of the force is in it: take all three components": _upwards_only,
        "every joint feels the force, not only the bucket's": _own_joint_only,
        (RADIANS): (lambda q, force: holding_torque(np.radians(q), force)),
    },
)
