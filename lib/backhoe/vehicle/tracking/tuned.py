"""The trackers of the comparison with our gains: the source prints none but Scaglia's.

Tuned by hand on the ideal and on the slipping vehicle of Husky size (`skid_steer.HUSKY`), for way-
points 0.1 to 0.3 m apart; lesson 05 shows what each gain does.
"""

from __future__ import annotations

from backhoe.vehicle.tracking.pid_tracker import PIDTracker
from backhoe.vehicle.tracking.pure_pursuit import PurePursuit
from backhoe.vehicle.tracking.scaglia_linear import ScagliaLinear
from backhoe.vehicle.tracking.scaglia_runge_kutta import ScagliaRungeKutta
from backhoe.vehicle.tracking.scaglia_taylor import ScagliaTaylor

SCAGLIA_PERIOD = 0.2
"""Sample time of Scaglia's three [s]. With a gain k they close k / T0 of an error in a second: at
50 Hz, k = 0.4 asks for 20 / s, far more than wheels that slip can follow; at 5 Hz, for 2 / s."""


def p_tracker(**options: object) -> PIDTracker:
    """The source's P: proportional gains alone. `options` go to PIDTracker."""
    return PIDTracker(rho=(1.25,), dy=(6.0,), alpha=(1.0,), **options)


def pi_tracker(**options: object) -> PIDTracker:
    """The source's PI, as the P with an integral of the lateral error; `options` as there.

    There is none of rho: a distance has no sign, so its integral can only grow.
    """
    return PIDTracker(rho=(1.25,), dy=(6.0, 6.0), alpha=(1.0,), **options)


def scaglia_taylor(**options: object) -> ScagliaTaylor:
    """Scaglia v1 with the source's gains, five times a second; `options` go to ScagliaTaylor."""
    return ScagliaTaylor(**{"period": SCAGLIA_PERIOD, **options})


def scaglia_linear(**options: object) -> ScagliaLinear:
    """Scaglia v2, with v1's gains and period; `options` go to ScagliaLinear."""
    return ScagliaLinear(**{"period": SCAGLIA_PERIOD, **options})


def scaglia_runge_kutta(**options: object) -> ScagliaRungeKutta:
    """Scaglia v3, repaired, with the listing's gains; `options` go to ScagliaRungeKutta."""
    return ScagliaRungeKutta(**{"period": SCAGLIA_PERIOD, **options})


TRACKERS = {
    "P": p_tracker,
    "PI": pi_tracker,
    "Scaglia v1": scaglia_taylor,
    "Scaglia v2": scaglia_linear,
    "Scaglia v3": scaglia_runge_kutta,
    "pure pursuit": PurePursuit,
}
"""Name -> function that makes the tracker; Scaglia's named as in D'Angelo's Fig. 6.3."""

TRACKERS_ON_TRACKS = {
    "P": p_tracker,
    "PI": lambda: PIDTracker(rho=(1.25,), dy=(6.0, 1.0), alpha=(1.0,)),
    "Scaglia v1": lambda: ScagliaTaylor(period=0.2),
    "Scaglia v2": lambda: ScagliaLinear(period=0.4),
    "Scaglia v3": lambda: ScagliaRungeKutta(period=0.4),
    "pure pursuit": lambda: PurePursuit(1.0),
}
"""The same for the backhoe, which is 17 t heavy and swings into its turns slowly."""
