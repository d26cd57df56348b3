"""The force of soil on a blade that cuts it, and the bearing capacity.

A blade pushed through soil shears a wedge loose ahead of it. Reece (1964) writes the force per
tool as P = (rho g d^2 N_gamma + c d N_c + q d N_q + c_a d N_a) w, the fundamental equation of
earth-moving; the N factors follow from the equilibrium of a plane wedge (Coulomb's trial wedge;
McKyes, Soil Cutting and Tillage, 1985; derived step by step by Wagner, arXiv:2505.19330).

P is a slanting force: it acts on the blade's face at the angle delta from its normal. With the
adhesion c_a along the face, a blade of rake alpha pushes the soil
    forwards with  P sin(alpha + delta) + c_a d w cot alpha,
    upwards with   P cos(alpha + delta) - c_a d w,
and the soil pushes back with the same: a flat blade is pulled into the ground, one steeper than
pi/2 - delta is lifted out of it. The wedge's two ends shear off beside the blade, which adds
    d^2 N_e (c + (1 - sin phi) tan phi (rho g d / 3 + q)),
    N_e = (cot alpha + cot beta) N_c sin beta,
to P: cohesion and the friction of earth pressure at rest on two triangles. Crescents that break
out further to the sides are left out.

Angles in radians: the rake alpha and the failure angle beta stand at the edge, alpha between the
face and the horizontal behind it, beta between the failure plane and the horizontal ahead.
"""

from __future__ import annotations

from functools import lru_cache
from math import cos, exp, hypot, pi, radians, sin, tan
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_numbers
from backhoe.simulation.soil.soils import SoilParameters

SHALLOWEST_RAKE = radians(15)
STEEPEST_RAKE = radians(100)
USUAL_DEPTH = 0.3
"""Of a cut, for which the failure planes are found [m]."""
_RAKES = np.linspace(SHALLOWEST_RAKE, STEEPEST_RAKE, 86)
_RAKE_STEP = float(_RAKES[1] - _RAKES[0])


class Cut(NamedTuple):
    """What a blade does to the soil that it brings to failure; the soil pushes back with the same.

    Attributes:
        normal: force into the soil, along the face's normal [N].
        rub: force on the soil down along the face: friction and adhesion [N].
        centre: from the edge up the face to where `normal` acts [m].
        rise: how fast the soil climbs a face without motion along itself, over its speed along its
            normal [1].
        rake: of the face [rad].
    """

    normal: float
    rub: float
    centre: float
    rise: float
    rake: float

    @property
    def forward(self) -> float:
        """Horizontal force on the soil [N]."""
        return self.normal * sin(self.rake) + self.rub * cos(self.rake)

    @property
    def upward(self) -> float:
        """Vertical force on the soil [N]."""
        return self.normal * cos(self.rake) - self.rub * sin(self.rake)


NO_CUT = Cut(0.0, 0.0, 0.0, 0.0, pi / 2)


def cut(
    soil: SoilParameters,
    depth: float,
    rake: float,
    width: float,
    surcharge: float,
    gravity: float,
) -> Cut:
    """The force with which a blade brings soil to failure; nothing where it is out of the ground.

    Its place is that of a pressure which grows with depth for the soil's own weight (a third of the
    face up from the edge) and is even for the rest (half way up).

    Args:
        soil: that is cut.
        depth: from the soil's surface down to the edge [m].
        rake: alpha [rad]; taken at the nearest end of the table outside 15 to 100 degrees (ahead
            of a steeper blade soil builds a wedge of its own).
        width: of the blade [m].
        surcharge: pressure on the surface ahead of the blade [Pa].
        gravity: [m/s^2].
    """
    if depth <= 0:
        return NO_CUT
    rake = min(max(rake, SHALLOWEST_RAKE), STEEPEST_RAKE)
    at = min((rake - SHALLOWEST_RAKE) / _RAKE_STEP, len(_RAKES) - 1.000001)
    row, part = int(at), at - int(at)
    below, above = _factor_rows(soil)[row : row + 2]
    n_gamma, n_c, n_q, n_a, n_e, rise = (
        a + part * (b - a) for a, b in zip(below, above, strict=True)
    )
    face, heavy = depth / sin(rake), soil.density * gravity * depth
    weight = heavy * depth * width * n_gamma
    even = (soil.cohesion * n_c + surcharge * n_q + soil.adhesion * n_a) * depth * width
    at_rest = (1 - sin(soil.friction)) * tan(soil.friction) * (heavy / 3 + surcharge)
    even += depth**2 * n_e * (soil.cohesion + at_rest)
    force = max(weight + even, 0.0)
    centre = face * (weight / 3 + even / 2) / force if force > 0.0 else 0.0
    return Cut(
        force * cos(soil.tool_friction),
        force * sin(soil.tool_friction) + soil.adhesion * face * width,
        min(max(centre, face / 3), face / 2),
        rise,
        rake,
    )


@lru_cache(maxsize=16)
def _factor_rows(soil: SoilParameters) -> list[list[float]]:
    """N_gamma, N_c, N_q, N_a, N_e and the soil's rise at each rake of the table."""
    beta = failure_angle(_RAKES, soil)
    N = wedge(_RAKES, beta, soil)
    ends = (1 / np.tan(_RAKES) + 1 / np.tan(beta)) * N[:, 1] * np.sin(beta)
    return np.column_stack([N, ends, -1 / np.tan(_RAKES + beta)]).tolist()


def wedge(alpha: ArrayLike, beta: ArrayLike, soil: SoilParameters) -> NDArray:
    """The N factors of the wedge that fails along a plane at angle beta.

    With D = cos(alpha + delta) + sin(alpha + delta) cot(beta + phi), the force at the angle delta
    to the blade's normal that brings the wedge to failure has
    N_gamma = (cot alpha + cot beta) / 2D, N_c = (1 + cot beta cot(beta + phi)) / D,
    N_q = 2 N_gamma, N_a = (1 - cot alpha cot(beta + phi)) / D.

    Args:
        alpha: rake angle, shape (...) [rad].
        beta: failure angle, shape (...) [rad].
        soil: gives phi and delta.

    Returns:
        N_gamma, N_c, N_q, N_a, shape (..., 4) [1].
    """
    alpha, beta = real_numbers(alpha, "alpha"), real_numbers(beta, "beta")
    cot_alpha, cot_beta = 1 / np.tan(alpha), 1 / np.tan(beta)
    cot_plane = 1 / np.tan(beta + soil.friction)
    tool = alpha + soil.tool_friction
    D = np.cos(tool) + np.sin(tool) * cot_plane
    n_q = (cot_alpha + cot_beta) / D
    n_c = (1 + cot_beta * cot_plane) / D
    n_a = (1 - cot_alpha * cot_plane) / D
    return np.stack(np.broadcast_arrays(n_q / 2, n_c, n_q, n_a), axis=-1)


def failure_angle(alpha: ArrayLike, soil: SoilParameters) -> NDArray:
    """Angle beta of the plane on which the soil gives way first [rad].

    That of the least rho g d N_gamma + c N_c + c_a N_a at a depth of 0.3 m on Earth, by golden
    section between beta = 0 and the beta at which the wedge would lock. At other depths, under a
    surcharge, and with the ends, the least force is smaller than on this plane: see the tests.

    Args:
        alpha: rake angle, shape (...) [rad].
        soil: its strength and weight.

    Returns:
        beta, shape (...) [rad].
    """
    alpha = real_numbers(alpha, "alpha")
    low = np.full_like(alpha, 1e-3)
    high = pi - alpha - soil.tool_friction - soil.friction - 1e-3
    golden = (5**0.5 - 1) / 2
    pulls = np.array([soil.density * 9.81 * USUAL_DEPTH, soil.cohesion, 0.0, soil.adhesion])
    for _ in range(80):
        left, right = high - golden * (high - low), low + golden * (high - low)
        keep_left = wedge(alpha, left, soil) @ pulls < wedge(alpha, right, soil) @ pulls
        low, high = np.where(keep_left, low, left), np.where(keep_left, right, high)
    return (low + high) / 2


def bearing_capacity(depth: float, soil: SoilParameters, gravity: float) -> float:
    """Pressure under which a strip footing sinks at `depth` [m] in loose soil [Pa].

    c' N_c + rho g d N_q with N_q = exp(pi tan phi') tan^2(pi/4 + phi'/2), N_c = (N_q - 1) cot phi'
    (Prandtl, Reissner). Loose soil fails locally before its strength is used up everywhere:
    c' = 2/3 c and tan phi' = 2/3 tan phi (Terzaghi).
    """
    slope = 2 / 3 * tan(soil.friction)
    sine = slope / hypot(1.0, slope)
    n_q = exp(pi * slope) * (1 + sine) / (1 - sine)
    n_c = (n_q - 1) / slope
    return 2 / 3 * soil.cohesion * n_c + soil.density * gravity * max(depth, 0.0) * n_q
