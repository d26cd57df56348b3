"""The trackers of the comparison with our gains: the source prints none but Scaglia's.

Tuned by hand on the ideal and on the slipping vehicle of Husky size (`skid_steer.HUSKY`), for way-
points 0.1 to 0.3 m apart; lesson 05 shows what each gain does.
"""

from __future__ import annotations

from backhoe.tracking.pid_tracker import PIDTracker
from backhoe.tracking.pure_pursuit import PurePursuit
from backhoe.tracking.scaglia_linear import ScagliaLinear
from backhoe.tracking.scaglia_runge_kutta import ScagliaRungeKutta
from backhoe.tracking.scaglia_taylor import ScagliaTaylor

__all__ = ["TRACKERS", "p_tracker", "pi_tracker"]


def p_tracker(**options: object) -> PIDTracker:
    """The source's P: proportional gains alone. `options` go to PIDTracker."""
    return PIDTracker(rho=(2.0,), dy=(8.0,), alpha=(1.0,), **options)


def pi_tracker(**options: object) -> PIDTracker:
    """The source's PI. `options` go to PIDTracker."""
    return PIDTracker(rho=(2.0, 0.2), dy=(8.0, 4.0), alpha=(1.0,), **options)


TRACKERS = {
    "P": p_tracker,
    "PI": pi_tracker,
    "Scaglia v1": ScagliaTaylor,
    "Scaglia v2": ScagliaLinear,
    "Scaglia v3": ScagliaRungeKutta,
    "pure pursuit": PurePursuit,
}
"""Name -> function without arguments that makes the tracker; the names of D'Angelo's Fig. 6.3."""
