"""Exercises 2.1, 2.2 and 2.5: weights, forces and their torques."""

from __future__ import annotations

from collections.abc import Callable
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


REST = np.zeros(4)
LENGTHS = BACKHOE.boom.length / BACKHOE.boom.com_radius
STEINER = BACKHOE.boom.mass * BACKHOE.boom.com_radius**2 / BACKHOE.boom.inertia


INERTIA = BACKHOE.boom.inertia * (1 + STEINER)


def _boom(**changes: float) -> partial:
    return partial(boom_acceleration, boom=replace(BACKHOE.boom, **changes))


def _times(factor: float) -> Callable[[float], float]:
    return lambda angle: factor * boom_acceleration(angle)


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
            _times(-1.0)
        ),
        "the boom turns about its joint: to I add m L_cm^2 (Steiner)": (_times(1 + STEINER)),
        "that is the torque: divide it by what resists, I + m L_cm^2": _times(INERTIA),
        "L_cm is squared in what resists: m L_cm^2": (
            _times((1 + STEINER) / (1 + STEINER / BACKHOE.boom.com_radius))
        ),
        "Steiner adds: I + m L_cm^2, not the difference": _times((1 + STEINER) / (1 - STEINER)),
        "what resists has L_cm, the way to the centre of mass, not the boom's length": (
            _times((1 + STEINER) / (1 + STEINER * LENGTHS**2))
        ),
        "the weight's torque has the boom's mass": _times(1 / BACKHOE.boom.mass),
        "the weight's torque has the lever arm L_cm": _times(1 / BACKHOE.boom.com_radius),
        "the weight pulls at L_cm; the boom's length has no place in it": _times(LENGTHS),
        "g is missing: a weight is m g": _times(1 / BACKHOE.gravity),
        "the sign of theta_cm2: q cm is q + theta_cm2": (
            lambda angle: boom_acceleration(angle - 2 * BACKHOE.boom.com_angle)
        ),
        "the lever arm of a weight is horizontal: the cosine of the angle, and another sign": (
            lambda angle: boom_acceleration(angle + np.pi / 2)
        ),
        "the boom is alone here: stick and bucket are away": (
            lambda angle: dynamics.forward_dynamics([0.0, angle, 0.0, 0.0], REST, REST)[1]
        ),
        "no number is rounded here: return all its digits": (
            lambda angle: round(boom_acceleration(angle), 2)
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
            _times(0.5)
        ),
        "a factor 2: differentiate dq^2 / 2 by dq once more": (_times(2.0)),
        RADIANS: lambda angle: boom_acceleration(np.radians(angle)),
    },
)

OFFSETS = np.array([0.0, *(link.angle_offset for link in BACKHOE.links)])
COMS = np.array([link.com_angle for link in BACKHOE.links])
RADII, LENGTH = (
    np.array([link.com_radius for link in BACKHOE.links]),
    np.array([link.length for link in BACKHOE.links[:2]]),
)
WEIGHTS = BACKHOE.gravity * np.array([link.mass for link in BACKHOE.links])
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


SUM_OF_COMS = (
    "only the last angle of a sum is that of a centre of mass: q2* + q3cm, not q2cm + q3cm"
)


def _formula(
    joints: NDArray = OFFSETS[1:],
    masses: NDArray = OFFSETS[1:],
    last: NDArray = COMS,
    shares: tuple[float, ...] = (1, 1, 1),
    carried: tuple[float, ...] = (1, 1),
) -> Callable[[ArrayLike], NDArray]:
    """The formula with its angles and terms as told.

    `joints` are the offsets summed up to the angles of boom and stick, `masses` those up to the
    link before a centre of mass, `last` that of the centre of mass itself; `shares` of stick and
    bucket at the boom's tip, of the bucket at the stick's; `carried` of g4 in g3 and g3 in g2.
    """

    def torque(q: ArrayLike) -> NDArray:
        turned = np.cumsum(np.asarray(q)[1:])
        before = np.append(0.0, np.cumsum(masses[:2]))
        arms = RADII * np.cos(turned + before + last)
        ends = LENGTH * np.cos(turned[:2] + np.cumsum(joints[:2]))
        own = WEIGHTS * arms
        g4 = own[2]
        g3 = own[1] + carried[0] * g4 + shares[2] * WEIGHTS[2] * ends[1]
        beyond = shares[0] * WEIGHTS[1] + shares[1] * WEIGHTS[2]
        return np.array([0.0, own[0] + carried[1] * g3 + beyond * ends[0], g3, g4])

    return torque


GRAVITY = Exercise(
    number="2.2",
    title="the torque that holds the arm",
    reference=dynamics.gravity_torque,
    oracle="slope_of_the_heights",
    cases=lambda rng: [(q,) for q in (*postures(rng, 150), *rng.uniform(-np.pi, np.pi, (50, 4)))],
    tested_on="200 random postures, some beyond the limits",
    hints=(
        "start at the bucket: g4 is the bucket's weight times its horizontal lever arm",
        "g3 = g4 + what the stick adds: its own weight, and the bucket's weight at the stick's tip",
    ),
    mistakes={
        "the sign: g holds the arm up, so an outstretched boom needs a positive g2": (
            lambda q: -dynamics.gravity_torque(q)
        ),
        "that is the form in the appendix: a length has no cosine, and a weight is missing": (
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
        SUM_OF_COMS: _formula(COMS, COMS),
        SUM_OF_COMS + " (yours has q* only for the links' ends)": _formula(masses=COMS),
        SUM_OF_COMS + " (yours has q cm for the links' ends)": _formula(joints=COMS),
        "the way to a link's end goes along q*, also that of the stick: q23*, not q23cm": (
            _formula(np.array([BACKHOE.boom.angle_offset, BACKHOE.stick.com_angle]))
        ),
        "the way to a link's end goes along q*, also that of the boom: q2*, not q2cm": (
            _formula(np.array([COMS[0], OFFSETS[2]]))
        ),
        "the bucket hangs at the stick's end, along q3*: q2* + q3* + q4cm": (
            _formula(masses=np.array([OFFSETS[1], BACKHOE.stick.com_angle]))
        ),
        "the boom's end is where q2* points; only its own weight has q2cm": (
            _formula(np.array([COMS[0], OFFSETS[2]]), np.array([COMS[0], OFFSETS[2]]))
        ),
        "no joint angle is yet the angle of its link: the offsets are missing": (
            _formula(np.zeros(2), np.zeros(2), np.zeros(3))
        ),
        "the bucket's weight at the stick's end is missing: m_bu L3 cos q23*": (
            _formula(shares=(1, 1, 0))
        ),
        "the bucket's weight at the boom's end is missing: m_bu L2 cos q2*": (
            _formula(shares=(1, 0, 1))
        ),
        "the stick's weight at the boom's end is missing: m_s L2 cos q2*": (
            _formula(shares=(0, 1, 1))
        ),
        "at the boom's end hang stick and bucket: (m_s + m_bu) L2 cos q2* is missing": (
            _formula(shares=(0, 0, 1))
        ),
        "g3 holds what the bucket's joint holds, too: add g4": _formula(carried=(0, 1)),
        "g2 holds what the stick's joint holds, too: add g3": _formula(carried=(1, 0)),
        "a torque has a sign: a weight on the machine's side of a joint pulls the other way": (
            lambda q: np.abs(dynamics.gravity_torque(q))
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
        "both signs are turned: the torque holds the arm up and pays for the push": (
            lambda q, force: -holding_torque(q, force)
        ),
        "the force acts at the teeth, not at the bucket's centre of mass": (
            partial(_held, frame="bucket_com")
        ),
        "the force has signs: do not take its absolute value": (
            lambda q, force: holding_torque(q, np.abs(force))
        ),
        "the base frame is where the force is given: do not turn it into the teeth's": (
            lambda q, force: _held(q, kinematics.forward_kinematics(q)[:3, :3].T @ force)
        ),
        "a torque from a force is J^T F; the pseudo-inverse is for speeds": (
            lambda q, force: (
                dynamics.gravity_torque(q) + np.linalg.pinv(kinematics.jacobian(q)[:3]) @ force
            )
        ),
        "the force comes in newtons already: no factor 1000": (
            lambda q, force: holding_torque(q, 1e3 * force)
        ),
        "the force counts once": lambda q, force: holding_torque(q, 2 * force),
        "gravity counts once": (
            lambda q, force: holding_torque(q, force) + dynamics.gravity_torque(q)
        ),
        "the arm's own weight is in g already: the force is only what the teeth exert": (
            lambda q, force: holding_torque(q, force + WEIGHTS[2] * np.array([0.0, 0.0, 1.0]))
        ),
        "one component of the force is missing: the force to the side turns the swing": (
            lambda q, force: holding_torque(q, force * np.array([1.0, 0.0, 1.0]))
        ),
        "the force comes as x, y, z: keep its order": (
            lambda q, force: holding_torque(q, force[::-1])
        ),
        "J^T, not J: rows of J are directions, its columns are joints": (
            lambda q, force: (
                dynamics.gravity_torque(q)
                + np.append(kinematics.jacobian(q)[:3] @ np.append(force, 0.0), 0.0)
            )
        ),
        "the swing feels the force, too, where gravity does not turn it": (
            lambda q, force: holding_torque(q, force) * np.array([0.0, 1.0, 1.0, 1.0])
        ),
        "every joint feels the force, not only the bucket's": lambda q, force: np.append(
            dynamics.gravity_torque(q)[:3], holding_torque(q, force)[3]
        ),
        RADIANS: lambda q, force: holding_torque(np.radians(q), force),
    },
)
