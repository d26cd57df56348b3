"""Lyapunov's method for the arm under PID: function, constants, certificates, gains.

- `candidate`: the closed loop, Kelly's function V and its derivative
- `extremes`: the constants k_g, k_C1 and the extreme eigenvalues of M
- `conditions`, `certificate`: what gains must satisfy, by three routes, and a verdict with numbers
- `region`: from where the motion ends in the goal
- `sampled_loop`, `tuning`: gains that satisfy the conditions and can be sampled
"""

from backhoe.arm.lyapunov.candidate import (
    State,
    closed_loop_rate,
    closed_loop_state,
    derivative,
    derivative_terms,
    function,
)
from backhoe.arm.lyapunov.certificate import Certificate, Condition, check_gains
from backhoe.arm.lyapunov.extremes import (
    Constants,
    Profile,
    christoffel,
    constants,
    gravity_slope,
    profile,
)
from backhoe.arm.lyapunov.region import Attraction, attraction
from backhoe.arm.lyapunov.sampled_loop import effective_inertia, sampled_radius
from backhoe.arm.lyapunov.tuning import Tuning, tune

__all__ = [
    "Attraction",
    "Certificate",
    "Condition",
    "Constants",
    "Profile",
    "State",
    "Tuning",
    "attraction",
    "check_gains",
    "christoffel",
    "closed_loop_rate",
    "closed_loop_state",
    "constants",
    "derivative",
    "derivative_terms",
    "effective_inertia",
    "function",
    "gravity_slope",
    "profile",
    "sampled_radius",
    "tune",
]
