"""Exercises 2.3, 2.4 and 2.6: the inertia matrix, its changes, and a printed entry."""

from __future__ import annotations

from collections.abc import Callable
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


def _share_of_the_load(factor: float) -> partial:
    return partial(_plus_times, factor)


def _plus_times(factor: float, q: ArrayLike, load: float) -> NDArray:
    return _plus_load(q, factor * load, "bucket_com")


def _spinning_load(q: ArrayLike, load: float) -> NDArray:
    more = 1 + load / BACKHOE.bucket.mass
    changes = {"mass": lambda b: b.mass * more, "inertia": lambda b: b.inertia * more}
    return dynamics.mass_matrix(q, variant("bucket", **changes))


def _flat(q: ArrayLike, load: float) -> NDArray:
    share = loaded_mass_matrix(q, load) - dynamics.mass_matrix(q)
    return share * (np.arange(4) > 0) * (np.arange(4) > 0)[:, None]


def _bucket_alone(q: ArrayLike, load: float) -> NDArray:
    rest = variant("swing", "boom", "stick", mass=NOTHING, inertia=NOTHING)
    return loaded_mass_matrix(q, load, rest)


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
        "the share of a point mass in M has no factor 1/2: that stands before M": (
            _share_of_the_load(0.5)
        ),
        "the load counts once": _share_of_the_load(2.0),
        "the load adds to what resists: plus its share": _share_of_the_load(-1.0),
        "an inertia has the mass, not the weight: no g": _share_of_the_load(BACKHOE.gravity),
        "the load comes in kilograms: no factor 1000": _share_of_the_load(1e-3),
        "a mass is no inertia: its share is m Jv^T Jv": (
            lambda q, load: dynamics.mass_matrix(q) + load
        ),
        "a mass is no inertia, nor on the diagonal: its share is m Jv^T Jv": (
            lambda q, load: dynamics.mass_matrix(q) + load * np.eye(4)
        ),
        "the load lies in the bucket, not at the stick's centre of mass": (
            partial(_plus_load, frame="stick_com")
        ),
        "the load lies in the bucket, not at the boom's centre of mass": (
            partial(_plus_load, frame="boom_com")
        ),
        "the load is a point without an inertia of its own: I_bu stays that of the empty bucket": (
            _spinning_load
        ),
        "the swing carries the load, too: all four columns of Jv": (
            lambda q, load: _flat(q, load) + dynamics.mass_matrix(q)
        ),
        "the load is in the bucket alone: the other links weigh what they weighed": (
            lambda q, load: dynamics.mass_matrix(q, variant(*BODIES, mass=lambda b: b.mass + load))
        ),
        "that is the bucket's share alone: the other bodies are missing": _bucket_alone,
        "an inertia matrix is full: the joints feel each other": (
            lambda q, load: np.diag(np.diag(loaded_mass_matrix(q, load)))
        ),
        "an inertia matrix is symmetric: the half below the diagonal is missing": (
            lambda q, load: np.triu(loaded_mass_matrix(q, load))
        ),
        "M depends on the posture: use q": (lambda q, load: loaded_mass_matrix(np.zeros(4), load)),
        "use the load that is given, not a tonne": lambda q, load: loaded_mass_matrix(q, 1000.0),
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
        "that is 1/2 Mdot dq: the right power, but not the right torques": (_terms(1 / 2, 0)),
        "Mdot dq is the first half: the term -1/2 dq^T (dM/dq_k) dq is missing": _terms(1, 0),
        "the second term has a factor 1/2: it comes from K = dq^T M dq / 2": _terms(1, -1),
        "in Mdot the first axis of dM belongs to dq: np.einsum('ikj,i->kj', dM, dq)": (
            _terms(0, 1 / 2)
        ),
        "the second term is subtracted: Lagrange's equation has - dL/dq": _terms(1, 1 / 2),
        "the sign: C dq stands on the left, beside M ddq": _terms(-1, 1 / 2),
        "that is the second half: the term Mdot dq is missing": _terms(0, -1 / 2),
        "a factor 1/2 too much: only the second term has one, Mdot dq has none": _terms(
            1 / 2, -1 / 2
        ),
        "the second term has the factor 1/2, not 1/4": _terms(1, -1 / 4),
        "C dq counts once: Mdot dq - 1/2 [...]": _terms(2, -1),
        "that is M dq: a momentum, no torque": lambda q, dq: dynamics.mass_matrix(q) @ dq,
        "Mdot is a sum over the joints with their speeds: dM[i] * dq[i], not dM.sum(axis=0)": (
            lambda q, dq: (
                dynamics.mass_matrix_derivative(q).sum(axis=0) @ dq + _two_terms(q, dq, 0, -1 / 2)
            )
        ),
        "Mdot must be multiplied with dq once more": (
            lambda q, dq: np.tensordot(dq, dynamics.mass_matrix_derivative(q), 1).sum(axis=1)
        ),
        "dq^T (dM/dq_k) dq has both speeds in it, not their squares": (
            lambda q, dq: (
                _two_terms(q, dq, 1, 0)
                - dynamics.mass_matrix_derivative(q) @ dq**2 @ np.ones(4) / 2
            )
        ),
        "only squares of speeds: the products dq_i dq_j, the Coriolis part, are missing": (
            lambda q, dq: coriolis_torque(q, np.diag(dq)).sum(axis=0)
        ),
        "there is gravity in it: at rest C dq must be zero": (
            lambda q, dq: coriolis_torque(q, dq) + dynamics.gravity_torque(q)
        ),
        "those are the printed forms of the appendix: hardly an entry of them is right": (
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


COM, END = BACKHOE.bucket.com_angle, BACKHOE.bucket.angle_offset


def _with_angles(turns: tuple[float, float], last: float | None) -> Callable[[ArrayLike], float]:
    """M33 with multiples of q2* and q3* in the angle; without q4 and with q3cm if last is None."""

    def wrong(q: ArrayLike) -> float:
        if last is None:
            return _bent(q, q[2] + BACKHOE.stick.com_angle - q[3] - COM)
        more = turns[0] * (q[1] + BACKHOE.boom.angle_offset)
        more += abs(turns[1]) * (q[2] + BACKHOE.stick.angle_offset)
        bucket = -(q[3] + last) if turns[1] < 0 else q[3] + last
        return _bent(q, more + bucket - q[3] - COM)

    return wrong


REPAIR = Exercise(
    number="2.6",
    title="repair a turn in M33",
    reference=m33,
    oracle="inertia_about_the_stick_joint",
    cases=lambda rng: [(q,) for q in postures(rng, 100)],
    tested_on="100 random postures",
    hints=(
        "which joints change how far the bucket's centre of mass is from the stick's joint?",
        "law of cosines: the angle between stick and bucket's centre of mass is q4cm alone",
    ),
    mistakes={
        "that is M33 as it stands: it changes when only the boom moves, and it must not": (
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
        **{
            f"the other joints are still in it: turning {name} moves nothing within": (
                _with_angles(turns, last)
            )
            for name, turns, last in (
                ("boom and stick twice, with q4cm,", (2, 2), COM),
                ("the stick twice, with q4*,", (0, 2), END),
                ("the stick twice, with q4cm,", (0, 2), COM),
                ("boom and stick once, with q4cm,", (1, 1), COM),
                ("boom and stick once, with q4*,", (1, 1), END),
                ("the stick once, with q4*,", (0, 1), END),
                ("the stick alone and not the bucket", (0, 1), None),
                ("the stick against the bucket", (0, -1), END),
            )
        },
        "the lengths of the law of cosines: L_cm4^2 + L_3^2 + ...; L_3^2 is missing": (
            lambda q: m33(q) - BACKHOE.bucket.mass * BACKHOE.stick.length**2
        ),
        "the lengths of the law of cosines: L_cm4^2 + L_3^2 + ...; L_cm4^2 is missing": (
            lambda q: m33(q) - BACKHOE.bucket.mass * BACKHOE.bucket.com_radius**2
        ),
        "the stick itself turns, too: m_s L_cm3^2 is missing": (
            lambda q: m33(q) - BACKHOE.stick.mass * BACKHOE.stick.com_radius**2
        ),
        "the stick's own inertia I_s is missing": lambda q: m33(q) - BACKHOE.stick.inertia,
        "the law of cosines has a cosine: a stretched arm has the largest inertia": (
            lambda q: _bent(q, -np.pi / 2)
        ),
        "the cross term is missing: the bucket's centre of mass moves about the stick's end": (
            lambda q: (m33(q) + _bent(q, np.pi)) / 2
        ),
        "the sign of the offset: q4cm is q4 + com_angle": (
            lambda q: _bent(q, -2 * BACKHOE.bucket.com_angle)
        ),
        "that is M22, about the boom's joint: M33 is about the stick's": (
            lambda q: dynamics.mass_matrix(q)[1, 1]
        ),
        "that is M44, about the bucket's joint: M33 is about the stick's": (
            lambda q: dynamics.mass_matrix(q)[3, 3]
        ),
        "M33 does change when the bucket turns: q4cm belongs in it": lambda q: m33(np.zeros(4)),
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
