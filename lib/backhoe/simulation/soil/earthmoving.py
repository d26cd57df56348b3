"""What soil does to a tool: strength, the cutting force and the bearing capacity.

A blade pushed through soil shears a wedge loose ahead of it. Reece (1964) writes the force per
tool as F = (rho g d^2 N_gamma + c d N_c + q d N_q + c_a d N_a) w, the fundamental equation of
earth-moving; the N factors follow from the equilibrium of a plane wedge (Coulomb's trial wedge;
McKyes, Soil Cutting and Tillage, 1985; derived step by step by Wagner, arXiv:2505.19330).
Angles in radians: rake alpha and failure angle beta are measured from the ground's surface.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from math import exp, hypot, pi, radians, tan

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, number, positive, real_numbers

SHALLOWEST_RAKE = radians(15)
STEEPEST_RAKE = radians(100)
_RAKES = np.linspace(SHALLOWEST_RAKE, STEEPEST_RAKE, 86)
_RAKE_STEP = float(_RAKES[1] - _RAKES[0])


SOURCES = {
    "density": ("kg/m^3", "typical of a moist sandy loam in a spoil heap"),
    "cohesion": ("Pa", "typical of a moist sandy loam (2 to 10 kPa)"),
    "friction": ("rad", "typical of a sandy loam (29 to 35 degrees)"),
    "tool_friction": ("rad", "two thirds of the internal friction, usual for soil on steel"),
    "adhesion": ("Pa", "ours: a tenth of the cohesion"),
    "repose": ("rad", "typical of loose earth, slightly above the internal friction"),
    "subgrade": ("Pa/m", "low end for a loose sand; it sets how far a resting bucket sinks"),
    "spill_rate": ("m^3/s", "ours: a full bucket empties in about a second"),
}


@dataclass(frozen=True)
class SoilParameters:
    """Strength and weight of the soil; `SOURCES` says where each default comes from.

    Dug and undisturbed soil share one density, so volume is kept when soil moves (no swell).

    Attributes:
        density: bulk density [kg/m^3].
        cohesion: cohesion c [Pa].
        friction: angle of internal friction phi [rad].
        tool_friction: angle of soil-steel friction delta [rad].
        adhesion: soil-steel adhesion c_a [Pa].
        repose: angle of repose, the steepest slope that stands [rad].
        subgrade: modulus of subgrade reaction, pressure per sinkage [Pa/m].
        spill_rate: fastest outflow over the bucket's lip [m^3/s].

    Raises:
        ValueError: a value is not a finite positive number (cohesion and adhesion may be zero), an
            angle is 45 degrees or more, or delta exceeds phi.
    """

    density: float = 1600.0
    cohesion: float = 6000.0
    friction: float = radians(33)
    tool_friction: float = radians(22)
    adhesion: float = 500.0
    repose: float = radians(34)
    subgrade: float = 8e6
    spill_rate: float = 0.8

    def __post_init__(self) -> None:
        for field in fields(self):
            name, value = f"soil {field.name}", getattr(self, field.name)
            check = not_negative if field.name in ("cohesion", "adhesion") else positive
            check(value, name, SOURCES[field.name][0])
        for name in ("friction", "tool_friction", "repose"):
            number(getattr(self, name), f"soil {name}", "rad", below=pi / 4)
        if self.tool_friction > self.friction:
            raise ValueError(
                "soil tool_friction must not exceed friction: the soil would shear in "
                f"itself first, got {self.tool_friction!r} and {self.friction!r} rad"
            )

    @cached_property
    def factor_table(self) -> NDArray:
        """N_gamma, N_c, N_q, N_a at each rake of the table, shape (rakes, 4)."""
        return cutting_factors(_RAKES, self)

    def cutting_force(
        self, depth: float, rake: float, width: float, surcharge: float, gravity: float
    ) -> float:
        """Reece's force on a blade [N]; zero where the blade is out of the ground.

        Args:
            depth: from the soil's surface down to the edge [m].
            rake: angle of the blade's face from the horizontal ahead [rad]; taken at the nearest
                end of the table outside 15 to 100 degrees (ahead of a steeper blade soil builds a
                wedge of its own).
            width: of the blade [m].
            surcharge: pressure on the surface ahead of the blade [Pa].
            gravity: [m/s^2].
        """
        if depth <= 0:
            return 0.0
        at = min(max((rake - SHALLOWEST_RAKE) / _RAKE_STEP, 0.0), len(_RAKES) - 1.000001)
        row, part = int(at), at - int(at)
        below, above = self._factor_rows[row], self._factor_rows[row + 1]
        n_gamma, n_c, n_q, n_a = (a + part * (b - a) for a, b in zip(below, above, strict=True))
        weight = self.density * gravity * depth**2 * n_gamma
        strength = self.cohesion * n_c + surcharge * n_q + self.adhesion * n_a
        return max(weight + strength * depth, 0.0) * width

    @cached_property
    def _factor_rows(self) -> list[list[float]]:
        return self.factor_table.tolist()


LOAM = SoilParameters()


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
    """Angle beta of the plane on which the soil gives way first: the least N_gamma [rad].

    Golden-section search between beta = 0 and the beta at which the wedge would lock.

    Args:
        alpha: rake angle, shape (...) [rad].
        soil: gives phi and delta.

    Returns:
        beta, shape (...) [rad].
    """
    alpha = real_numbers(alpha, "alpha")
    low = np.full_like(alpha, 1e-3)
    high = pi - alpha - soil.tool_friction - soil.friction - 1e-3
    golden = (5**0.5 - 1) / 2
    for _ in range(80):
        left, right = high - golden * (high - low), low + golden * (high - low)
        keep_left = wedge(alpha, left, soil)[..., 0] < wedge(alpha, right, soil)[..., 0]
        low, high = np.where(keep_left, low, left), np.where(keep_left, right, high)
    return (low + high) / 2


def cutting_factors(alpha: ArrayLike, soil: SoilParameters) -> NDArray:
    """N_gamma, N_c, N_q, N_a of the wedge that fails first.

    Args:
        alpha: rake angle between the blade's face and the horizontal ahead, shape (...) [rad].
        soil: gives phi and delta.

    Returns:
        Factors, shape (..., 4) [1].

    Raises:
        ValueError: a rake outside 15 to 100 degrees, or not finite.
    """
    alpha = real_numbers(alpha, "alpha")
    inside = (alpha >= SHALLOWEST_RAKE - 1e-12) & (alpha <= STEEPEST_RAKE + 1e-12)
    if not inside.all():
        wrong = np.degrees(alpha[~inside]).flat[0]
        raise ValueError(f"rake must lie in 15 to 100 degrees, got {wrong:.1f} degrees")
    return wedge(alpha, failure_angle(alpha, soil), soil)


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
