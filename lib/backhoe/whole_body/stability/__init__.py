"""What keeps the machine on its tracks: balance, margins, and the loads that tip it.

- `terms`: the ground's force and moment from all masses and accelerations, written once
- `polygon`: what the tracks stand on, and distances inside it
- `balance`: centre of mass, zero-moment point, static and dynamic margin, level or on a slope
- `lifting`: tipping load, rated load, the lifting chart
"""

from backhoe.whole_body.stability.balance import (
    Margin,
    centre_of_mass,
    centre_of_mass_jacobian,
    gravity_on_slope,
    margin,
    zero_moment_point,
)
from backhoe.whole_body.stability.lifting import (
    DRIVE_SHARE,
    OVER,
    TIPPING_SHARE,
    LiftingChart,
    Tipping,
    lifting_chart,
    tipping_load,
)
from backhoe.whole_body.stability.polygon import EDGES, distances, support_polygon

__all__ = [
    "DRIVE_SHARE",
    "EDGES",
    "OVER",
    "TIPPING_SHARE",
    "LiftingChart",
    "Margin",
    "Tipping",
    "centre_of_mass",
    "centre_of_mass_jacobian",
    "distances",
    "gravity_on_slope",
    "lifting_chart",
    "margin",
    "support_polygon",
    "tipping_load",
    "zero_moment_point",
]
