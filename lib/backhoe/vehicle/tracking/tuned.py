"""The trackers of the comparison with our gains: the source prints none but Scaglia's.

Tuned by hand on the ideal and on the slipping vehicle of Husky size (`skid_steer.HUSKY`), for way-
points 0.1 to 0.3 m apart.

Scaglia's three have the gains of the source, and so not the same poles: for a gain k, v2 asks for
twice the turn of v1. With kw2 = 0.8, v1 drives as v2 does with kw = 0.4, to a millimetre.
"""

from __future__ import annotations

from functools import partial

from backhoe.vehicle.tracking.pid_tracker import PIDTracker
from backhoe.vehicle.tracking.pure_pursuit import PurePursuit
from backhoe.vehicle.tracking.scaglia_linear import ScagliaLinear
from backhoe.vehicle.tracking.scaglia_runge_kutta import ScagliaRungeKutta
from backhoe.vehicle.tracking.scaglia_taylor import ScagliaTaylor

SCAGLIA_PERIOD = 0.2
"""Sample time of Scaglia's three [s]. With a gain k they close k / T0 of an error in a second: at
50 Hz, k = 0.4 asks for 20 / s, far more than wheels that slip can follow; at 5 Hz, for 2 / s."""

_P = {"rho": (1.25,), "dy": (6.0,), "alpha": (1.0,)}

TRACKERS = {
    "P": partial(PIDTracker, **_P),
    "PI": partial(PIDTracker, **_P | {"dy": (6.0, 6.0)}),
    "Scaglia v1": partial(ScagliaTaylor, period=SCAGLIA_PERIOD),
    "Scaglia v2": partial(ScagliaLinear, period=SCAGLIA_PERIOD),
    "Scaglia v3": partial(ScagliaRungeKutta, period=SCAGLIA_PERIOD),
    "pure pursuit": PurePursuit,
}
"""Name -> what makes the tracker, with options of its class; Scaglia's named as in D'Angelo's Fig.
6.3. The PI integrates the lateral error alone: a distance has no sign, so the integral of rho can
only grow."""

TRACKERS_ON_TRACKS = {
    "P": partial(PIDTracker, **_P),
    "PI": partial(PIDTracker, **_P | {"dy": (6.0, 1.0)}),
    "Scaglia v1": partial(ScagliaTaylor, period=0.2),
    "Scaglia v2": partial(ScagliaLinear, period=0.4),
    "Scaglia v3": partial(ScagliaRungeKutta, period=0.4),
    "pure pursuit": partial(PurePursuit, 1.0),
}
"""The same for the backhoe, which is 21.5 t heavy and swings into its turns slowly."""
