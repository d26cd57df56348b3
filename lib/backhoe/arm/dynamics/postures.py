"""The terms at one posture, in floats, and at many, in arrays: arrangement only.

A single call in floats takes a third of the time of NumPy on arrays of one. Many postures go
through NumPy tile by tile; from `MANY` on, mass matrix and inverse dynamics go through loops
compiled by Numba when it is installed. The numbers agree to rounding.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.dynamics.terms import (
    Arm,
    Vectors,
    arm_of,
    gravity_torques,
    inertia_slopes,
    inertias,
    mass_height,
    newton_euler,
    solve_inertias,
    vectors,
)
from backhoe.arm.kinematics.forward import leading_shape
from backhoe.basics.tiles import for_each_tile
from backhoe.machine import Machine

MANY = 200_000
TILE = 4096


def evaluate(
    write: Callable, tail: tuple[int, ...], machine: Machine, *vectors: NDArray
) -> NDArray:
    """Call `write(out, arm, posture, *others)` for one posture in floats, for many in arrays."""
    arm = arm_of(machine)
    if all(vector.ndim == 1 for vector in vectors):
        out = np.zeros(tail)
        first, *others = (vector.tolist() for vector in vectors)
        write(out, arm, posture(arm, first, math.cos, math.sin), *others)
        return out
    lead = leading_shape(*vectors)
    flat = [np.broadcast_to(vector, (*lead, 4)).reshape(-1, 4) for vector in vectors]
    out = np.empty((len(flat[0]), *tail))
    compiled = _compiled(write) if len(out) >= MANY else None

    def evaluate_tile(tile: slice) -> None:
        out[tile] = 0.0
        first, *others = (np.ascontiguousarray(vector[tile].T) for vector in flat)
        write(out[tile], arm, posture(arm, first, np.cos, np.sin), *others)

    def run_compiled_tile(tile: slice) -> None:
        parts = (np.require(vector[tile], requirements=("C", "W")) for vector in flat)
        compiled(Arm(*map(float, arm)), *parts, out[tile])

    for_each_tile(run_compiled_tile if compiled else evaluate_tile, len(out), TILE)
    return out.reshape(lead + tail)


def posture(arm: Arm, q: list[float] | NDArray, cos: Callable, sin: Callable) -> Vectors:
    p2 = q[1] + arm.o2
    p3 = p2 + (q[2] + arm.o3)
    p4 = p3 + (q[3] + arm.o4)
    return vectors(arm, cos(p2), sin(p2), cos(p3), sin(p3), cos(p4), sin(p4))


def _compiled(write: Callable) -> Callable | None:
    """The compiled loop that does what `write` does; None without one or without Numba."""
    if write not in _COMPILED:
        return None
    try:
        from backhoe.arm.dynamics import engine
    except ImportError:
        return None
    return getattr(engine, _COMPILED[write])


def write_mass_matrix(M: NDArray, arm: Arm, v: Vectors) -> None:
    M11, M22, M23, M24, M33, M34, M44 = inertias(arm, v)
    M[..., 0, 0] = M11
    M[..., 1, 1] = M22
    M[..., 1, 2] = M[..., 2, 1] = M23
    M[..., 1, 3] = M[..., 3, 1] = M24
    M[..., 2, 2] = M33
    M[..., 2, 3] = M[..., 3, 2] = M34
    M[..., 3, 3] = M44


def write_mass_matrix_derivative(dM: NDArray, arm: Arm, v: Vectors) -> None:
    by_q2, by_q3, by_q4, l2_l3, l2_c4, l3_c4 = inertia_slopes(arm, v)
    dM[..., 1, 0, 0] = by_q2
    dM[..., 2, 0, 0] = by_q3
    dM[..., 3, 0, 0] = by_q4
    dM[..., 2, 1, 1] = 2 * (l2_l3 + l2_c4)
    dM[..., 2, 1, 2] = dM[..., 2, 2, 1] = l2_l3 + l2_c4
    dM[..., 2, 1, 3] = dM[..., 2, 3, 1] = l2_c4
    dM[..., 3, 1, 1] = 2 * (l2_c4 + l3_c4)
    dM[..., 3, 1, 2] = dM[..., 3, 2, 1] = l2_c4 + 2 * l3_c4
    dM[..., 3, 1, 3] = dM[..., 3, 3, 1] = l2_c4 + l3_c4
    dM[..., 3, 2, 2] = 2 * l3_c4
    dM[..., 3, 2, 3] = dM[..., 3, 3, 2] = l3_c4


def write_gravity_torque(g: NDArray, arm: Arm, v: Vectors) -> None:
    g[..., 1], g[..., 2], g[..., 3] = gravity_torques(arm, v)


def write_mass_height(moment: NDArray, arm: Arm, v: Vectors) -> None:
    moment[...] = mass_height(arm, v)


def write_inverse_dynamics(tau: NDArray, arm: Arm, v: Vectors, dq: Sequence, ddq: Sequence) -> None:
    tau[..., 0], tau[..., 1], tau[..., 2], tau[..., 3] = newton_euler(arm, v, *dq, *ddq)


def write_forward_dynamics(ddq: NDArray, arm: Arm, v: Vectors, dq: Sequence, tau: Sequence) -> None:
    h1, h2, h3, h4 = newton_euler(arm, v, *dq, 0.0, 0.0, 0.0, 0.0)
    free = tau[0] - h1, tau[1] - h2, tau[2] - h3, tau[3] - h4
    ddq[..., 0], ddq[..., 1], ddq[..., 2], ddq[..., 3] = solve_inertias(inertias(arm, v), *free)


_COMPILED = {
    write_mass_matrix: "mass_matrices",
    write_inverse_dynamics: "inverse_dynamics",
}
