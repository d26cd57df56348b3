"""The constants of the analysis: k_g, k_C1 and the extreme eigenvalues of M.

||g(x) - g(y)|| <= k_g ||x - y||             (A.13)
||C(q, x) y|| <= k_C1 ||x|| ||y||            (A.8, with its sign turned)
lambda_min I <= M(q) <= lambda_max I         (A.2), (A.3)

"Tight" constants are the smallest that hold: k_g is the largest spectral norm of dg/dq, k_C1 the
largest norm of the bilinear map C. "Printed" ones follow the thesis's recipes of single entries.

Source: Mastalli 2013, section 3.4.1 and Appendix A.1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.dynamics import mass_matrix, mass_matrix_derivative
from backhoe.arm.dynamics.postures import evaluate
from backhoe.arm.dynamics.terms import Arm, Vectors
from backhoe.arm.kinematics import joint_vector
from backhoe.arm.lyapunov.bilinear import bilinear_norm
from backhoe.arm.lyapunov.suprema import Domain, domain_of, largest_norm, supremum
from backhoe.basics.inputs import choice, instance
from backhoe.basics.tiles import for_each_tile
from backhoe.machine import BACKHOE, Machine

RECIPES = ("tight", "printed")
_TILE = 512


@dataclass(frozen=True)
class Constants:
    """Constants of the arm over a set of postures.

    `kg` [N m/rad], `kc1`, `lambda_min`, `lambda_max` [kg m^2]; `ratio` is the largest
    lambda_max^2/lambda_min of one posture [kg m^2]; `largest_slope` max |dg_i/dq_j| [N m/rad] and
    `largest_symbol` max |C_kij| [kg m^2] are what the printed recipes start from. `domain` "box",
    "torus" or "postures", with `q` (n, 4) [rad] in the last case; `where` gives for each constant
    the posture (4,) [rad] that decides it.
    """

    kg: float
    kc1: float
    lambda_min: float
    lambda_max: float
    ratio: float
    largest_slope: float
    largest_symbol: float
    domain: str
    recipe: str
    machine: Machine
    q: NDArray | None
    where: MappingProxyType

    def replace(self, **changes: float) -> Constants:
        """A copy with other numbers, such as the thesis's printed ones."""
        return replace(self, **changes)

    @property
    def over(self) -> Domain:
        """The set of postures."""
        return domain_of(self.q, "box" if self.q is not None else self.domain, self.machine)


class Profile(NamedTuple):
    """Posture by posture, shape (...) each: what Figs. 3.5 to 3.8 show, and the tight constants.

    `slope` max |dg_i/dq_j| [N m/rad], `symbol` max |C_kij|, `lambda_min`, `lambda_max`, `ratio`
    lambda_max^2/lambda_min [kg m^2]; `kg` the spectral norm of dg/dq, `kc1` the norm of C(q, .).
    """

    slope: NDArray
    symbol: NDArray
    lambda_min: NDArray
    lambda_max: NDArray
    ratio: NDArray
    kg: NDArray
    kc1: NDArray


def constants(
    q: ArrayLike | None = None,
    *,
    domain: str = "box",
    recipe: str = "tight",
    machine: Machine = BACKHOE,
) -> Constants:
    """The constants over postures, over the joint box, or over all angles.

    Over the postures of a movement they say nothing of the postures between and beside them.

    Source: Mastalli 2013, (3.31), (3.32), (A.2), (A.3), (A.8), (A.13).

    Args:
        q: postures, shape (..., 4) [rad]; None for the whole domain.
        domain: "box" (within the joint limits) or "torus" (all angles), when q is None.
        recipe: "tight" for the smallest constants; "printed" for k_g = n max |dg_i/dq_j| and
            k_C1 = n^2 max |C_kij| with n = 4.
        machine: the arm; `variants.loaded` for a full bucket.

    Returns:
        Constants. Those of a whole domain are kept: the second call costs nothing.

    Raises:
        ValueError: an unknown domain or recipe, no posture, not 4 joints, not finite.
    """
    choice(recipe, "recipe", RECIPES)
    if q is None:
        domain_of(None, domain, machine)
        found = _of_domain(domain, machine)
    else:
        found = _over(domain_of(q, machine=machine), machine)
    if recipe == "tight":
        return found
    where = {**found.where, "kg": found.where["largest_slope"]}
    where["kc1"] = found.where["largest_symbol"]
    return found.replace(
        kg=4 * found.largest_slope,
        kc1=16 * found.largest_symbol,
        recipe="printed",
        where=MappingProxyType(where),
    )


def constants_of(given: Constants | None) -> Constants:
    """The constants that a caller means: `given`, or the tight ones of the joint box.

    Raises:
        TypeError: they are no Constants.
    """
    if given is None:
        return constants()
    return instance(given, "constants", Constants, "give what lyapunov.constants(...) returns")


def profile(q: ArrayLike, *, machine: Machine = BACKHOE) -> Profile:
    """The constants' ingredients posture by posture.

    Source: Mastalli 2013, Figs. 3.5 to 3.8, which show them along the loading movement.

    Args:
        q: postures, shape (..., 4) [rad]. A thousand take about a tenth of a second.

    Raises:
        ValueError: the last axis is not 4, or a value is not finite.
    """
    q = joint_vector(q)
    rows = q.reshape(-1, 4)
    kc1 = np.empty(len(rows))

    def measure_tile(tile: slice) -> None:
        kc1[tile] = bilinear_norm(christoffel(rows[tile], machine=machine))[0]

    for_each_tile(measure_tile, len(rows), _TILE)
    ends = _eigenvalues(rows, machine)
    columns = (
        _slope(rows, machine),
        _symbol(rows, machine),
        ends[:, 0],
        ends[:, -1],
        ends[:, -1] ** 2 / ends[:, 0],
        _spectral(rows, machine),
        kc1,
    )
    return Profile(*(column.reshape(q.shape[:-1]) for column in columns))


def gravity_slope(q: ArrayLike, *, machine: Machine = BACKHOE) -> NDArray:
    """Derivative of the gravity torques: the Hessian of the potential energy.

    Args:
        q: joint angles, shape (..., 4) [rad].

    Returns:
        dg/dq with [..., i, j] = dg_i/dq_j, symmetric, shape (..., 4, 4) [N m/rad].

    Raises:
        ValueError: the last axis is not 4, or a value is not finite.
    """
    return evaluate(_write_gravity_slope, (4, 4), machine, joint_vector(q))


def christoffel(q: ArrayLike, *, machine: Machine = BACKHOE) -> NDArray:
    """The symmetric matrices C_k with (C(q, x) y)_k = x^T C_k y.

    Source: Mastalli 2013, (A.7).

    Args:
        q: joint angles, shape (..., 4) [rad].

    Returns:
        C with [..., k, i, j], shape (..., 4, 4, 4) [kg m^2].

    Raises:
        ValueError: the last axis is not 4, or a value is not finite.
    """
    dM = mass_matrix_derivative(q, machine)
    by_i, by_j = np.einsum("...ikj->...kij", dM), np.einsum("...jki->...kij", dM)
    return (by_i + by_j - dM) / 2


def _write_gravity_slope(H: NDArray, arm: Arm, v: Vectors) -> None:
    by_q4 = -arm.g * arm.m_bu * v.c4z
    by_q3 = by_q4 - arm.g * (arm.m_s * v.c3z + arm.m_bu * v.l3z)
    H[..., 1, 1] = by_q3 - arm.g * (arm.m_bo * v.c2z + (arm.m_s + arm.m_bu) * v.l2z)
    H[..., 1, 2] = H[..., 2, 1] = H[..., 2, 2] = by_q3
    H[..., 1, 3] = H[..., 3, 1] = H[..., 2, 3] = H[..., 3, 2] = H[..., 3, 3] = by_q4


def _eigenvalues(q: NDArray, machine: Machine) -> NDArray:
    return np.linalg.eigvalsh(mass_matrix(q, machine))


def _slope(q: NDArray, machine: Machine) -> NDArray:
    return np.abs(gravity_slope(q, machine=machine)).max(axis=(-2, -1))


def _symbol(q: NDArray, machine: Machine) -> NDArray:
    return np.abs(christoffel(q, machine=machine)).max(axis=(-3, -2, -1))


def _spectral(q: NDArray, machine: Machine) -> NDArray:
    return np.abs(np.linalg.eigvalsh(gravity_slope(q, machine=machine))).max(axis=-1)


@lru_cache(maxsize=32)
def _of_domain(name: str, machine: Machine) -> Constants:
    return _over(domain_of(None, name, machine), machine)


def _over(domain: Domain, machine: Machine) -> Constants:
    found = {
        "kg": supremum(lambda q: _spectral(q, machine), domain),
        "kc1": largest_norm(lambda q: christoffel(q, machine=machine), domain),
        "lambda_min": supremum(lambda q: 1 / _eigenvalues(q, machine)[:, 0], domain),
        "lambda_max": supremum(lambda q: _eigenvalues(q, machine)[:, -1], domain),
        "ratio": supremum(lambda q: _ratio(q, machine), domain),
        "largest_slope": supremum(lambda q: _slope(q, machine), domain),
        "largest_symbol": supremum(lambda q: _symbol(q, machine), domain),
    }
    values = {name: peak.value for name, peak in found.items()}
    values["lambda_min"] = 1 / values["lambda_min"]
    where = {}
    for name, peak in found.items():
        where[name] = np.array(peak.posture)
        where[name].flags.writeable = False
    given = domain.q if domain.name == "postures" else None
    return Constants(
        **values,
        domain=domain.name,
        recipe="tight",
        machine=machine,
        q=given,
        where=MappingProxyType(where),
    )


def _ratio(q: NDArray, machine: Machine) -> NDArray:
    ends = _eigenvalues(q, machine)
    return ends[:, -1] ** 2 / ends[:, 0]
