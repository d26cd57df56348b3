"""Exercises 2.3, 2.4 and 2.6: the inertia matrix, its changes, and a printed entry."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics, kinematics
from backhoe.lessons.dynamics import printed
from backhoe.lessons.dynamics.exercises.postures import (
    BODIES,
    LINKS,
    NOTHING,
    RADIANS,
    postures,
    variant,
)
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE, Machine, replace
from backhoe.machine.variants import loaded

SPINS = np.diag([BACKHOE.swing.inertia, *(link.inertia for link in BACKHOE.links)])
WITHOUT_SPIN = variant(*BODIES, inertia=NOTHING)
ENDS = replace(
    variant(*LINKS, com_radius=lambda b: b.length, com_angle=lambda b: b.angle_offset),
    swing=replace(BACKHOE.swing, com_radius=BACKHOE.swing.offset, com_angle=0.0),
)


def loaded_mass_matrix(q: ArrayLike, load: float, machine: Machine = BACKHOE) -> NDArray:
    """M(q) with `load` kg at the bucket's centre of mass [kg m^2]."""
    return dynamics.mass_matrix(q, machine=loaded(load, machine))


def _plus_load(q: ArrayLike, load: float, frame: str, rows: int = 3) -> NDArray:
    J = kinematics.jacobian(q, frame)[:rows]
    return dynamics.mass_matrix(q) + load * J.T @ J


def _of(machine: Machine) -> partial:
    return partial(loaded_mass_matrix, machine=machine)


MASS_MATRIX = Exercise(
    number="2.3",
    title="the inertia matrix with a load in the bucket",
    reference=loaded_mass_matrix,
    oracle="kinetic_energy",
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
            partial(_plus_load, frame="tip")
        ),
        "the load lies at the bucket's centre of mass, not at the bucket's pin": (
            partial(_plus_load, frame="stick")
        ),
        "the bucket itself weighs something too: add the load to its mass": (
            _of(variant("bucket", mass=NOTHING))
        ),
        "the load is a point: only Jv, the first three rows of the Jacobian, counts for it": (
            partial(_plus_load, frame="bucket_com", rows=6)
        ),
        "that is the load's share alone: the arm itself is missing": (
            lambda q, load: loaded_mass_matrix(q, load) - dynamics.mass_matrix(q)
        ),
        "a factor 2: K = dq^T M dq / 2 has the half outside of M": (
            lambda q, load: loaded_mass_matrix(q, load) / 2
        ),
        "the links also turn: I Jw^T Jw is missing": _of(WITHOUT_SPIN),
        "the links also travel: m Jv^T Jv is missing": (
            lambda q, load: dynamics.mass_matrix(q, variant(*BODIES, mass=NOTHING))
        ),
        "those are Jacobians of the links' ends: take the centres of mass, boom_com": _of(ENDS),
        "the turret turns too: the first body is swing_com": (
            _of(variant("swing", mass=NOTHING, inertia=NOTHING))
        ),
        "the bucket turns with every joint before it: Jw has more than one column": (
            lambda q, load: loaded_mass_matrix(q, load, WITHOUT_SPIN) + SPINS
        ),
        "m L_cm^2 counts twice: with Jv of the centre of mass, I is the one about that point": (
            _of(variant(*BODIES, inertia=lambda b: b.inertia + b.mass * b.com_radius**2))
        ),
        RADIANS: lambda q, load: loaded_mass_matrix(np.radians(q), load),
    },
)


def coriolis_torque(q: ArrayLike, dq: ArrayLike) -> NDArray:
    """C(q, dq) dq [N m]."""
    return dynamics.coriolis_matrix(q, dq) @ np.asarray(dq)


def _two_terms(q: ArrayLike, dq: ArrayLike, first: float, second: float) -> NDArray:
    """A multiple of Mdot dq, and one of dq^T (dM/dq_k) dq for k = 1..4."""
    dM = dynamics.mass_matrix_derivative(q)
    return first * np.tensordot(dq, dM, 1) @ dq + second * dM @ dq @ dq


def _terms(first: float, second: float) -> partial:
    return partial(_two_terms, first=first, second=second)


CORIOLIS = Exercise(
    number="2.4",
    title="centrifugal and Coriolis torques",
    reference=coriolis_torque,
    oracle="lagrange_without_gravity",
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
            _terms(1 / 2, 0)
        ),
        "Mdot dq is the first half: the term -1/2 dq^T (dM/dq_k) dq is missing": _terms(1, 0),
        "the second term has a factor 1/2: it comes from K = dq^T M dq / 2": _terms(1, -1),
        "in Mdot the first axis of dM belongs to dq: np.einsum('ikj,i->kj', dM, dq)": (
            _terms(0, 1 / 2)
        ),
        "the second term is subtracted: Lagrange's equation has - dL/dq": _terms(1, 1 / 2),
        "the sign: C dq stands on the left, beside M ddq": _terms(-1, 1 / 2),
        "only squares of speeds: the products dq_i dq_j, the Coriolis part, are missing": (
            lambda q, dq: coriolis_torque(q, np.diag(dq)).sum(axis=0)
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


def _bent(q: ArrayLike, more: float) -> float:
    return m33(q + np.array([0.0, 0.0, 0.0, more]))


REPAIR = Exercise(
    number="2.6",
    title="repair the printed M33",
    reference=m33,
    oracle="inertia_about_the_stick_joint",
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
            lambda q: _bent(q, BACKHOE.bucket.angle_offset - BACKHOE.bucket.com_angle)
        ),
        "q4 is not yet the angle between the links: add the offset of the centre of mass": (
            lambda q: _bent(q, -BACKHOE.bucket.com_angle)
        ),
        "the stick's own angle is still in it: turning both together changes nothing": (
            lambda q: _bent(q, q[2] + BACKHOE.stick.angle_offset)
        ),
        "the cross term of a square has a factor 2; without it you have the term of M34": (
            lambda q: (3 * m33(q) + _bent(q, np.pi)) / 4
        ),
        "the sign of the cross term: a stretched arm (cos = 1) has the largest inertia": (
            lambda q: _bent(q, np.pi)
        ),
        "the links' own inertias I_s and I_bu are missing": (
            lambda q: m33(q) - BACKHOE.stick.inertia - BACKHOE.bucket.inertia
        ),
        "the bucket turns with the stick's joint too: I_bu is missing": (
            lambda q: m33(q) - BACKHOE.bucket.inertia
        ),
        RADIANS: lambda q: m33(np.radians(q)),
    },
)
