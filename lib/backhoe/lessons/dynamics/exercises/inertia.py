"""Exercises 2.3, 2.4 and 2.6: the inertia matrix, its changes, and a printed entry."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics, kinematics
from backhoe.lessons.dynamics import printed
from backhoe.lessons.dynamics.exercises.postures import RADIANS, postures, variant
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE
from backhoe.machine.variants import loaded

CENTRES = ("swing_com", "boom_com", "stick_com", "bucket_com")
BODIES = (BACKHOE.swing, *BACKHOE.links)
FOLDED = BACKHOE.stick.angle_offset + BACKHOE.bucket.com_angle


def loaded_mass_matrix(q: ArrayLike, load: float) -> NDArray:
    """M(q) with `load` kg at the bucket's centre of mass [kg m^2]."""
    return dynamics.mass_matrix(q, machine=loaded(load))


def _point_load(q: ArrayLike, load: float, frame: str) -> NDArray:
    Jv = kinematics.jacobian(q, frame)[:3]
    return load * Jv.T @ Jv


def _spin(q: ArrayLike, load: float) -> NDArray:
    Jw = kinematics.jacobian(q, "bucket_com")[3:]
    return load * Jw.T @ Jw


def _sum_of_links(
    q: ArrayLike,
    load: float,
    frames: tuple[str, ...] = CENTRES,
    linear: float = 1.0,
    angular: float = 1.0,
    first: int = 0,
) -> NDArray:
    M = linear * _point_load(q, load, frames[-1])
    for body, frame in list(zip(BODIES, frames, strict=True))[first:]:
        J = kinematics.jacobian(q, frame)
        M += linear * body.mass * J[:3].T @ J[:3] + angular * body.inertia * J[3:].T @ J[3:]
    return M


def _inertia_on_the_diagonal(q: ArrayLike, load: float) -> NDArray:
    return _sum_of_links(q, load, angular=0.0) + np.diag([body.inertia for body in BODIES])


def _steiner_twice(q: ArrayLike, load: float) -> NDArray:
    M = _sum_of_links(q, load)
    for body, frame in zip(BODIES, CENTRES, strict=True):
        Jw = kinematics.jacobian(q, frame)[3:]
        M += body.mass * body.com_radius**2 * Jw.T @ Jw
    return M


MASS_MATRIX = Exercise(
    number="2.3",
    title="the inertia matrix with a load in the bucket",
    reference=loaded_mass_matrix,
    cases=lambda rng: list(zip(postures(rng, 100), rng.uniform(100, 1500, 100), strict=True)),
    tested_on="100 random postures and loads",
    hints=(
        "the load is a fifth body: a point mass, so it has m Jv^T Jv and no I Jw^T Jw",
        'its Jacobian is the one of "bucket_com"; the sum over the other four is in the lesson',
    ),
    mistakes={
        "the load changes nothing in your function: it is one more mass in the bucket": (
            lambda q, load: dynamics.mass_matrix(q)
        ),
        "the load lies at the bucket's centre of mass, not at its teeth": (
            lambda q, load: dynamics.mass_matrix(q) + _point_load(q, load, "tip")
        ),
        "the load lies at the bucket's centre of mass, not at the bucket's pin": (
            lambda q, load: dynamics.mass_matrix(q) + _point_load(q, load, "stick")
        ),
        "the bucket itself weighs something too: add the load to its mass": (
            lambda q, load: dynamics.mass_matrix(q, variant(bucket={"mass": load}))
        ),
        "the load is a point: only Jv, the first three rows of the Jacobian, counts for it": (
            lambda q, load: loaded_mass_matrix(q, load) + _spin(q, load)
        ),
        "that is the load's share alone: the arm itself is missing": (
            lambda q, load: _point_load(q, load, "bucket_com")
        ),
        "a factor 2: K = dq^T M dq / 2 has the half outside of M": (
            lambda q, load: loaded_mass_matrix(q, load) / 2
        ),
        "the links also turn: I Jw^T Jw is missing": (
            lambda q, load: _sum_of_links(q, load, angular=0.0)
        ),
        "the links also travel: m Jv^T Jv is missing": (
            lambda q, load: _sum_of_links(q, load, linear=0.0)
        ),
        "those are Jacobians of the links' ends: take the centres of mass, boom_com": (
            lambda q, load: _sum_of_links(q, load, frames=("swing", "boom", "stick", "tip"))
        ),
        "the turret turns too: the first body is swing_com": (
            lambda q, load: _sum_of_links(q, load, first=1)
        ),
        "the bucket turns with every joint before it: Jw has more than one column": (
            _inertia_on_the_diagonal
        ),
        "m L_cm^2 counts twice: with Jv of the centre of mass, I is the one about that point": (
            _steiner_twice
        ),
        (RADIANS): (lambda q, load: loaded_mass_matrix(np.radians(q), load)),
    },
)


def coriolis_torque(q: ArrayLike, dq: ArrayLike) -> NDArray:
    """C(q, dq) dq [N m]."""
    return dynamics.coriolis_matrix(q, dq) @ np.asarray(dq)


def _m_dot(q: ArrayLike, dq: ArrayLike) -> NDArray:
    return np.einsum("kij,k->ij", dynamics.mass_matrix_derivative(q), dq)


def _pull(q: ArrayLike, dq: ArrayLike) -> NDArray:
    return np.einsum("kij,i,j->k", dynamics.mass_matrix_derivative(q), dq, dq)


def _squares_only(q: ArrayLike, dq: ArrayLike) -> NDArray:
    return sum(coriolis_torque(q, dq * unit) for unit in np.eye(4))


CORIOLIS = Exercise(
    number="2.4",
    title="centrifugal and Coriolis torques",
    reference=coriolis_torque,
    cases=lambda rng: list(zip(postures(rng, 50), rng.uniform(-1, 1, (50, 4)), strict=True)),
    rtol=1e-5,
    atol=1e-2,
    tested_on="50 random postures and speeds",
    hints=(
        "two terms: how M changes as you move, and how the energy changes with the posture",
        "C dq = Mdot dq - 1/2 [dq^T (dM/dq_k) dq for k = 1..4]",
    ),
    mistakes={
        "that is 1/2 Mdot dq, as (A.20) prints: the right power, but not the right torques": (
            lambda q, dq: _m_dot(q, dq) @ dq / 2
        ),
        "Mdot dq is the first half: the term -1/2 dq^T (dM/dq_k) dq is missing": (
            lambda q, dq: _m_dot(q, dq) @ dq
        ),
        "the second term has a factor 1/2: it comes from K = dq^T M dq / 2": (
            lambda q, dq: _m_dot(q, dq) @ dq - _pull(q, dq)
        ),
        "in Mdot the first axis of dM belongs to dq: np.einsum('ikj,i->kj', dM, dq)": (
            lambda q, dq: _pull(q, dq) / 2
        ),
        "the second term is subtracted: Lagrange's equation has - dL/dq": (
            lambda q, dq: _m_dot(q, dq) @ dq + _pull(q, dq) / 2
        ),
        "the sign: C dq stands on the left, beside M ddq": lambda q, dq: -coriolis_torque(q, dq),
        "only squares of speeds: the products dq_i dq_j, the Coriolis part, are missing": (
            _squares_only
        ),
        "there is gravity in it: at rest C dq must be zero": (
            lambda q, dq: coriolis_torque(q, dq) + dynamics.gravity_torque(q)
        ),
        "those are the printed forms (2.16) to (2.20): hardly an entry of them is right": (
            printed.coriolis_vector
        ),
    },
)


def m33(q: ArrayLike) -> float:
    """M33 at q: inertia of stick and bucket about the stick's joint [kg m^2]."""
    stick, bucket = BACKHOE.stick, BACKHOE.bucket
    reach = stick.length**2 + bucket.com_radius**2
    reach += 2 * stick.length * bucket.com_radius * np.cos(q[3] + bucket.com_angle)
    return stick.mass * stick.com_radius**2 + bucket.mass * reach + stick.inertia + bucket.inertia


def _m33(q: ArrayLike, *, angle: float | None = None, factor: float = 2.0) -> float:
    stick, bucket = BACKHOE.stick, BACKHOE.bucket
    angle = q[3] + bucket.com_angle if angle is None else angle
    cross = stick.length * bucket.com_radius * np.cos(angle)
    difference = factor * cross - 2 * stick.length * bucket.com_radius * np.cos(
        q[3] + bucket.com_angle
    )
    return m33(q) + bucket.mass * difference


REPAIR = Exercise(
    number="2.6",
    title="repair the printed M33",
    reference=m33,
    cases=lambda rng: [(q,) for q in postures(rng, 100)],
    tested_on="100 random postures",
    hints=(
        "which joints change how far the bucket's centre of mass is from the stick's joint?",
        "law of cosines: the angle between stick and bucket's centre of mass is q4cm alone",
    ),
    mistakes={
        "that is M33 as printed: it changes when only the boom moves, and it must not": (
            lambda q: printed.mass_matrix(q)[2, 2]
        ),
        "the angle is nearly right: the centre of mass lies at q4cm, the teeth at q4*": (
            lambda q: _m33(q, angle=q[3] + BACKHOE.bucket.angle_offset)
        ),
        "q4 is not yet the angle between the links: add the offset of the centre of mass": (
            lambda q: _m33(q, angle=q[3])
        ),
        "the stick's own angle is still in it: turning both together changes nothing": (
            lambda q: _m33(q, angle=q[2] + q[3] + FOLDED)
        ),
        "the cross term of a square has a factor 2; without it you have the term of M34": (
            lambda q: _m33(q, factor=1.0)
        ),
        "the sign of the cross term: a stretched arm (cos = 1) has the largest inertia": (
            lambda q: _m33(q, factor=-2.0)
        ),
        "the links' own inertias I_s and I_bu are missing": (
            lambda q: m33(q) - BACKHOE.stick.inertia - BACKHOE.bucket.inertia
        ),
        "the bucket turns with the stick's joint too: I_bu is missing": (
            lambda q: m33(q) - BACKHOE.bucket.inertia
        ),
        (RADIANS): (lambda q: m33(np.radians(q))),
    },
)
