"""Exercises 2.1, 2.2 and 2.5: weights, forces and their torques."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics, kinematics
from backhoe.lessons.dynamics import printed
from backhoe.lessons.dynamics.exercises.postures import (
    LINKS,
    NOTHING,
    RADIANS,
    postures,
    variant,
)
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE, Link, replace


def boom_acceleration(angle: float, boom: Link = BACKHOE.boom) -> float:
    """Acceleration of the boom alone, from rest [rad/s^2], at the joint angle `angle` [rad]."""
    weight_torque = boom.mass * BACKHOE.gravity * boom.com_radius * np.cos(angle + boom.com_angle)
    return -weight_torque / (boom.inertia + boom.mass * boom.com_radius**2)


STEINER = BACKHOE.boom.mass * BACKHOE.boom.com_radius**2 / BACKHOE.boom.inertia


def _boom(**changes: float) -> partial:
    return partial(boom_acceleration, boom=replace(BACKHOE.boom, **changes))


BOOM_ALONE = Exercise(
    number="2.1",
    title="the boom alone, let go",
    reference=boom_acceleration,
    oracle="lagrange_with_one_angle",
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
            lambda angle: boom_acceleration(angle) * (1 + STEINER)
        ),
        "a boom is not a point mass: its own inertia I belongs beside m L_cm^2": (
            _boom(inertia=NOTHING)
        ),
        "the weight pulls at the centre of mass, L_cm from the joint, not at the boom's tip": (
            _boom(com_radius=BACKHOE.boom.length)
        ),
        "theta_2 points at the boom's tip; the centre of mass lies at theta_cm2": (
            _boom(com_angle=BACKHOE.boom.angle_offset)
        ),
        "q is not yet the angle above the horizontal: add theta_cm2": _boom(com_angle=0.0),
        "the lever arm of a weight is horizontal: the cosine of the angle, not its sine": (
            lambda angle: boom_acceleration(angle - np.pi / 2)
        ),
        "a factor 2: the 1/2 of the kinetic energy goes when you differentiate by the speed": (
            lambda angle: boom_acceleration(angle) / 2
        ),
        "a factor 2: differentiate dq^2 / 2 by dq once more": (
            lambda angle: 2 * boom_acceleration(angle)
        ),
        RADIANS: lambda angle: boom_acceleration(np.radians(angle)),
    },
)

OFFSETS = np.array([0.0, *(link.angle_offset for link in BACKHOE.links)])
ALONE = [variant(*(other for other in LINKS if other != name), mass=NOTHING) for name in LINKS]


def _weight_of(machine: object) -> partial:
    return partial(dynamics.gravity_torque, machine=machine)


def _own_weight(q: ArrayLike) -> NDArray:
    own = [dynamics.gravity_torque(q, machine)[k] for k, machine in enumerate(ALONE, 1)]
    return np.array([0.0, *own])


def _inwards(shares: NDArray) -> NDArray:
    """Torques of the joints that carry these shares, shape (4,), and all those beyond."""
    return np.append(0.0, np.cumsum(shares[:0:-1])[::-1])


def _own_angles(q: ArrayLike) -> NDArray:
    levelled = np.where(np.tri(4, k=-1, dtype=bool), -OFFSETS, q)
    g = dynamics.gravity_torque(levelled)
    return _inwards(np.diag(g) - np.append(np.diag(g, 1), 0.0))


GRAVITY = Exercise(
    number="2.2",
    title="the torque that holds the arm",
    reference=dynamics.gravity_torque,
    oracle="slope_of_the_heights",
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
            _weight_of(variant("bucket", mass=NOTHING))
        ),
        "a link's own weight pulls at its centre of mass, L_cm from its joint, not at its end": (
            _weight_of(variant(*LINKS, com_radius=lambda link: link.length))
        ),
        "a joint carries every link beyond it, not only its own": _own_weight,
        "stick and bucket hang at the boom's tip: (m_s + m_bu) L2 cos q2* is missing": (
            lambda q: _inwards(_own_weight(q))
        ),
        "a weight's lever arm needs the absolute angle of its link: q2* + q3cm, not q3cm alone": (
            _own_angles
        ),
        "the last angle in each term is that of the centre of mass, com_angle": (
            _weight_of(variant(*LINKS, com_angle=lambda link: link.angle_offset))
        ),
        "the lever arm of a weight is horizontal: cosines, not sines": (
            lambda q: dynamics.gravity_torque(q - np.array([0.0, np.pi / 2, 0.0, 0.0]))
        ),
        "a factor 9.81: a weight is m g": lambda q: dynamics.gravity_torque(q) / BACKHOE.gravity,
        "a factor 1000: give N m, not kN m": lambda q: dynamics.gravity_torque(q) / 1e3,
        RADIANS: lambda q: dynamics.gravity_torque(np.radians(q)),
    },
)


def holding_torque(q: ArrayLike, tip_force: ArrayLike) -> NDArray:
    """Torque [N m] that holds the arm still while its tip exerts `tip_force` [N], base frame."""
    return dynamics.inverse_dynamics(q, np.zeros(4), np.zeros(4), tip_force=tip_force)


def _held(q: ArrayLike, load: ArrayLike, frame: str = "tip", rows: slice = slice(3)) -> NDArray:
    return dynamics.gravity_torque(q) + kinematics.jacobian(q, frame)[rows].T @ load


HOLD = Exercise(
    number="2.5",
    title="hold still while the teeth push",
    reference=holding_torque,
    oracle="virtual_work",
    cases=lambda rng: list(zip(postures(rng, 100), rng.uniform(-3e4, 3e4, (100, 3)), strict=True)),
    tested_on="100 random postures and forces",
    hints=(
        "two torques: what gravity asks for, and what the force asks for",
        "a force F at a point with velocity J dq needs the torque J^T F: only the linear rows of J",
    ),
    mistakes={
        "the sign of the force: h_e is what the teeth exert, so J^T h_e adds to the torque": (
            lambda q, force: holding_torque(q, -force)
        ),
        "the force changes nothing in your function: add J^T times it": (
            lambda q, force: dynamics.gravity_torque(q)
        ),
        "the arm is heavy: add the gravity torque": (
            lambda q, force: holding_torque(q, force) - dynamics.gravity_torque(q)
        ),
        "the sign of gravity: the torque holds the arm up, so + g": (
            lambda q, force: -holding_torque(q, -force)
        ),
        'the teeth are the frame "tip"; "stick" is the bucket\'s pin': partial(
            _held, frame="stick"
        ),
        "the force is given in the base frame already: do not turn it": (
            lambda q, force: _held(q, kinematics.forward_kinematics(q)[:3, :3] @ force)
        ),
        "those are the angular rows of J, for moments: a force takes the first three": (
            partial(_held, rows=slice(3, 6))
        ),
        "only the vertical part of the force is in it: take all three components": (
            lambda q, force: holding_torque(q, force * np.array([0.0, 0.0, 1.0]))
        ),
        "every joint feels the force, not only the bucket's": lambda q, force: np.append(
            dynamics.gravity_torque(q)[:3], holding_torque(q, force)[3]
        ),
        RADIANS: lambda q, force: holding_torque(np.radians(q), force),
    },
)
