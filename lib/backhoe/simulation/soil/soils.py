"""Named soils: strength and weight, each number with where it is published.

`SOILS` has them by name, in the order from easy to hard digging; "sandy loam" is what a world has
when nobody asks for another. Soils vary: these are typical figures, not measurements of a site.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import pi, radians

from backhoe.basics.inputs import choice, not_negative, number, positive
from backhoe.basics.named import named, shown_by_name

UNITS = {
    "density": "kg/m^3",
    "cohesion": "Pa",
    "friction": "rad",
    "tool_friction": "rad",
    "adhesion": "Pa",
    "repose": "rad",
    "subgrade": "Pa/m",
    "spill_rate": "m^3/s",
}


@shown_by_name
@dataclass(frozen=True)
class SoilParameters:
    """Strength and weight of a soil; the defaults are those of a moist sandy loam.

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
            angle is 45 degrees or more, delta exceeds phi, or c_a exceeds c.
    """

    density: float = 1600.0
    cohesion: float = 6000.0
    friction: float = radians(33)
    tool_friction: float = radians(22)
    adhesion: float = 0.0
    repose: float = radians(34)
    subgrade: float = 8e6
    spill_rate: float = 0.8

    def __post_init__(self) -> None:
        for field in fields(self):
            name, value = f"soil {field.name}", getattr(self, field.name)
            check = not_negative if field.name in ("cohesion", "adhesion") else positive
            check(value, name, UNITS[field.name])
        for name in ("friction", "tool_friction", "repose"):
            number(getattr(self, name), f"soil {name}", "rad", below=pi / 4)
        for at_steel, inside in (("tool_friction", "friction"), ("adhesion", "cohesion")):
            if getattr(self, at_steel) > getattr(self, inside):
                raise ValueError(
                    f"soil {at_steel} must not exceed {inside}: the soil would shear in itself "
                    f"first, got {getattr(self, at_steel)!r} and {getattr(self, inside)!r} "
                    f"{UNITS[inside]}"
                )


DRY_SAND = named(
    "DRY_SAND", SoilParameters(1600.0, 0.0, radians(30), radians(17), 0.0, radians(34), 10e6)
)
GRAVEL = named(
    "GRAVEL", SoilParameters(1520.0, 0.0, radians(38), radians(22), 0.0, radians(38), 30e6)
)
SANDY_LOAM = named("SANDY_LOAM", SoilParameters())
LOAM = named("LOAM", SoilParameters(1530.0, 20e3, radians(20), radians(10), 0.0, radians(35), 12e6))
CLAY_LOAM = named(
    "CLAY_LOAM", SoilParameters(1430.0, 30e3, radians(10), radians(6), 0.0, radians(35), 24e6)
)
STIFF_CLAY = named(
    "STIFF_CLAY", SoilParameters(1800.0, 50e3, radians(20), radians(12), 30e3, radians(40), 48e6)
)

SOILS = {
    "dry sand": DRY_SAND,
    "gravel": GRAVEL,
    "sandy loam": SANDY_LOAM,
    "loam": LOAM,
    "clay loam": CLAY_LOAM,
    "stiff clay": STIFF_CLAY,
}

_TILLAGE = "Typical Soil Properties (tillage), scribd.com/document/373830430"
_BOWLES = "Bowles, Foundation Analysis and Design, Table 9-1, scribd.com/document/474576018"
_STEEL = (
    "Carter and Bentley, Soil Properties and their Correlations, Table 11.1 (after US Navy 1982), "
    "scribd.com/document/433946424"
)
_REPOSE = (
    "table of angles of repose, buildsum.blogspot.com/2014/06/angle-of-repose-zone-of-influence"
)
_DENSITY = "table of bulk densities, doi.org/10.1201/b12981-45"
_CLAYS = "illustrative engineering properties, Table 2.3, issuhub.com/view/index/4734?pageIndex=82"
_USCS = "soil cohesion values by class (USCS), pumptcp.com/iztol5cr/soil-cohesion-value-table"
_SPILL = "ours: a full bucket empties in about a second"
_SAME_ADHESION = f"negligible in all but wet, sticky soils: {_TILLAGE}"

SOURCES = {
    "dry sand": {
        "density": f"sand, dry, 1602: {_DENSITY}",
        "cohesion": f"almost zero in dry loose sand: {_TILLAGE}",
        "friction": f"loose sands 25 to 30 degrees: {_TILLAGE}",
        "tool_friction": f"clean sand on steel, tan delta = 0.30: {_STEEL}",
        "adhesion": _SAME_ADHESION,
        "repose": f"dry sand 34 degrees: {_REPOSE}",
        "subgrade": f"loose sand 4.8 to 16 MN/m^3: {_BOWLES}",
        "spill_rate": _SPILL,
    },
    "gravel": {
        "density": f"gravel, dry, loose, 1522: {_DENSITY}",
        "cohesion": f"poorly graded gravel (GP), none: {_USCS}",
        "friction": f"poorly graded gravel (GP), 38 degrees: {_USCS}",
        "tool_friction": f"clean gravel on steel, tan delta = 0.40: {_STEEL}",
        "adhesion": _SAME_ADHESION,
        "repose": f"loose dry gravel 30 to 45 degrees: {_REPOSE}",
        "subgrade": f"as a medium dense sand, 9.6 to 80 MN/m^3: {_BOWLES}",
        "spill_rate": _SPILL,
    },
    "sandy loam": {
        "density": f"top soils 11 to 18 kN/m^3: {_TILLAGE}",
        "cohesion": f"friable moist sandy loam 5 to 15 kPa: {_TILLAGE}",
        "friction": f"above loose sand's 30, below a compact sandy loam's 40 degrees: {_TILLAGE}",
        "tool_friction": f"sandy loam on steel 20 to 22 degrees: {_TILLAGE}",
        "adhesion": _SAME_ADHESION,
        "repose": f"as dry sand, 34 degrees: {_REPOSE}",
        "subgrade": f"as a loose sand, 4.8 to 16 MN/m^3: {_BOWLES}",
        "spill_rate": _SPILL,
    },
    "loam": {
        "density": f"15 kN/m^3: {_TILLAGE}",
        "cohesion": f"20 kPa: {_TILLAGE}",
        "friction": f"20 degrees: {_TILLAGE}",
        "tool_friction": f"10 degrees: {_TILLAGE}",
        "adhesion": _SAME_ADHESION,
        "repose": f"in lumps, as clay, 25 to 40 degrees: {_REPOSE}",
        "subgrade": f"clayey soil of up to 200 kPa, 12 to 24 MN/m^3: {_BOWLES}",
        "spill_rate": _SPILL,
    },
    "clay loam": {
        "density": f"14 kN/m^3: {_TILLAGE}",
        "cohesion": f"30 kPa: {_TILLAGE}",
        "friction": f"10 degrees: {_TILLAGE}",
        "tool_friction": f"6 degrees: {_TILLAGE}",
        "adhesion": _SAME_ADHESION,
        "repose": f"dry lump clay 25 to 40 degrees: {_REPOSE}",
        "subgrade": f"clayey soil of up to 200 kPa, 12 to 24 MN/m^3: {_BOWLES}",
        "spill_rate": _SPILL,
    },
    "stiff clay": {
        "density": f"clays 15 to 21 kN/m^3: {_CLAYS}",
        "cohesion": f"medium to stiff clay 50 kPa: {_CLAYS}",
        "friction": f"medium to stiff clay 20 degrees: {_CLAYS}",
        "tool_friction": f"0.5 to 0.7 of the internal friction: {_TILLAGE}",
        "adhesion": f"stiff clay on steel 30 to 60 kPa: {_STEEL}",
        "repose": f"dry lump clay 25 to 40 degrees: {_REPOSE}",
        "subgrade": f"clayey soil of 200 to 800 kPa, 24 to 48 MN/m^3: {_BOWLES}",
        "spill_rate": _SPILL,
    },
}
"""Where each number of each named soil comes from."""


def soil_of(soil: str | SoilParameters) -> SoilParameters:
    """The soil of a name, or the parameters themselves.

    Args:
        soil: a name in `SOILS`, or `SoilParameters` of your own.

    Raises:
        ValueError: no soil has that name; the message lists those there are.
    """
    if isinstance(soil, SoilParameters):
        return soil
    return SOILS[choice(soil, "soil", tuple(SOILS))]
