"""Exercises 1.6 and 1.7: inverse kinematics for any target; the damped step that (2.4) meant."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.kinematics import printed
from backhoe.lessons.kinematics.exercises.posture import OFFSETS, random_postures
from backhoe.machine import BACKHOE, replace


def inverse_kinematics(target: ArrayLike) -> NDArray:
    """q that brings the stick's tip to x, y, z [m] with the bucket joint at an angle [rad]."""
    x, y, z, bucket = target
    L2, L3 = BACKHOE.boom.length, BACKHOE.stick.length
    swing = np.arctan2(-(x - BACKHOE.base.offset), y)
    k = np.hypot(x - BACKHOE.base.offset, y) - BACKHOE.swing.offset
    h = z - BACKHOE.base.height - BACKHOE.swing.height
    bend = -np.arccos((k**2 + h**2 - L2**2 - L3**2) / (2 * L2 * L3))
    pitch = np.arctan2(h, k) - np.arctan2(L3 * np.sin(bend), L2 + L3 * np.cos(bend))
    boom, stick = pitch - BACKHOE.boom.angle_offset, bend - BACKHOE.stick.angle_offset
    return np.array([swing, boom, stick, bucket])


def _elbow_down(target: ArrayLike) -> NDArray:
    q = _gamma_added(target)
    q[2] = -q[2] - 2 * OFFSETS[1]
    return q


def _of_machine(target: ArrayLike, **parts: object) -> NDArray:
    """Solution with some numbers of the machine left out; NaN where that is out of reach."""
    machine = replace(BACKHOE, **parts)
    return kinematics.inverse_kinematics(target, machine=machine, limits=False, on_failure="nan")


def _unwrapped(target: ArrayLike) -> NDArray:
    q = inverse_kinematics(target)
    q[0] = np.arctan2(target[1], target[0] - BACKHOE.base.offset) - np.pi / 2
    return q


def _half_plane(target: ArrayLike) -> NDArray:
    q = inverse_kinematics(target)
    q[0] = np.arctan(target[1] / (target[0] - BACKHOE.base.offset)) - np.pi / 2
    return q


def _gamma_added(target: ArrayLike) -> NDArray:
    q = inverse_kinematics(target)
    bend, L2, L3 = q[2] + OFFSETS[1], BACKHOE.boom.length, BACKHOE.stick.length
    q[1] += 2 * np.arctan2(L3 * np.sin(bend), L2 + L3 * np.cos(bend))
    return q


def _plus(target: ArrayLike, change: ArrayLike) -> NDArray:
    return inverse_kinematics(target) + change


INVERSE = Exercise(
    number="1.6",
    title="Inverse kinematics",
    reference=inverse_kinematics,
    cases=lambda rng: [(target,) for target in kinematics.pose(random_postures(rng, 100))],
    mistakes={
        "that is elbow down, outside the limits: take the other sign of the bend": _elbow_down,
        "right but for whole turns of the swing: bring it into -pi..pi": _unwrapped,
        "np.arctan cannot tell front from back: use np.arctan2 for the swing": _half_plane,
        "the swing is a quarter turn off: at q1 = 0 the arm points left": (
            lambda target: _plus(target, (np.pi / 2, 0, 0, 0))
        ),
        "the swing axis is not at the base's origin: take b0 off x first": (
            lambda target: _of_machine(target, base=replace(BACKHOE.base, offset=0.0))
        ),
        "the triangle starts at the boom's joint, b1 away from the swing axis": (
            lambda target: _of_machine(target, swing=replace(BACKHOE.swing, offset=0.0))
        ),
        "the triangle starts at the boom's joint: take L0 + L1 off z": (
            lambda target: _of_machine(target, base=replace(BACKHOE.base, height=0.0))
        ),
        "the boom's joint is L0 + L1 above the ground: L1 is missing": (
            lambda target: _of_machine(target, swing=replace(BACKHOE.swing, height=0.0))
        ),
        "with the elbow up the boom points above d: the sign of gamma is wrong": _gamma_added,
        "these are q2* and q3*: take the offsets off to get q": (
            lambda target: _plus(target, (0, *OFFSETS[:2], 0))
        ),
    },
    hints=(
        "Swing first; then the triangle of boom, stick and d in the arm's plane; offsets last.",
        "bend = q3* = -arccos((d^2 - L2^2 - L3^2) / (2 L2 L3)); q2* = beta + gamma of the figure.",
    ),
    tested_on="100 random targets all round the machine",
)


def damped_step(J: ArrayLike, error: ArrayLike, damping: float) -> NDArray:
    """dq that reduces |J dq - error|^2 + damping^2 |dq|^2, for J of any shape (m, n)."""
    J = np.asarray(J)
    return J.T @ np.linalg.solve(J @ J.T + damping**2 * np.eye(len(J)), error)


def _damped_cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for index, q in enumerate(random_postures(rng, 40)):
        if index % 2:
            q[2] = -BACKHOE.stick.angle_offset - rng.uniform(0.02, 0.2)
        J = kinematics.task_jacobian(q)
        J = J[: 3 if index % 4 == 3 else 4]
        cases.append((J, rng.uniform(-0.5, 0.5, len(J)), rng.uniform(0.05, 0.4)))
    return cases


def _weighted(J: NDArray, error: NDArray, damping: float, weight: object) -> NDArray:
    U, sigma, Vt = np.linalg.svd(J, full_matrices=False)
    return Vt.T @ (weight(sigma, damping) * (U.T @ error))


def _square_only(J: NDArray, error: NDArray, damping: float) -> NDArray:
    U, sigma, Vt = np.linalg.svd(J)
    return Vt.T @ np.diag(sigma / (sigma**2 + damping**2)) @ U.T @ error


def _vt_for_v(J: NDArray, error: NDArray, damping: float) -> NDArray:
    U, sigma, Vt = np.linalg.svd(J)
    return Vt @ np.diag(sigma / (sigma**2 + damping**2)) @ U.T @ error


def _mixed(J: NDArray, error: NDArray, damping: float) -> NDArray:
    return J.T @ np.linalg.solve(J.T @ J + damping**2 * np.eye(4), error)


DAMPED = Exercise(
    number="1.7",
    title="Repair (2.4)",
    reference=damped_step,
    cases=_damped_cases,
    mistakes={
        "that is (2.4) as printed: J + lambda^2 I can be singular itself": (
            lambda J, error, damping: printed.inverse_24(J, damping) @ error
        ),
        "that is the middle of (2.5): 1/(sigma + lambda^2) never gets small near sigma = 0": (
            lambda J, error, damping: printed.inverse_25(J, damping) @ error
        ),
        "there is no damping in it: near the stretched arm it asks for enormous steps": (
            lambda J, error, damping: np.linalg.solve(J, error)
        ),
        "that is the pseudoinverse, which has no damping: near the stretched arm it explodes": (
            lambda J, error, damping: np.linalg.pinv(J) @ error
        ),
        (
            "right while J is square: with three rows svd(J, full_matrices=False) makes the "
            "shapes fit"
        ): _square_only,
        "np.linalg.svd returns U, sigma and V^T, transposed already: V is V_T.T": _vt_for_v,
        "the damping enters squared: lambda^2 I": (
            lambda J, error, damping: damped_step(J, error, np.sqrt(damping))
        ),
        "a J^T is missing: J^T (J J^T + lambda^2 I)^-1 e": (
            lambda J, error, damping: np.linalg.solve(J @ J.T + damping**2 * np.eye(4), error)
        ),
        "J^T (J J^T + ...)^-1 or (J^T J + ...)^-1 J^T: you have mixed the two forms": _mixed,
        "the damping is added to sigma^2, not taken off": (
            lambda J, error, damping: _weighted(
                J, error, damping, lambda s, lam: s / (s**2 - lam**2)
            )
        ),
    },
    hints=(
        "Minimise |J dq - e|^2 + lambda^2 |dq|^2: set its gradient to zero.",
        "(J^T J + lambda^2 I) dq = J^T e; or with the SVD: the weights of (2.6), which are right.",
    ),
    rtol=1e-6,
    atol=1e-8,
    tested_on="40 random steps, half near the stretched arm, some with three wishes only",
)
