"""Lyapunov's method for the arm under PID: function, constants, certificates, gains.

- `candidate`: the closed loop, Kelly's function V and its derivative
- `inequalities`: the bounds on both that lead to the conditions
- `extremes`: the constants k_g, k_C1 and the extreme eigenvalues of M
- `conditions`, `certificate`: what gains must satisfy, by three routes, and a verdict with numbers
- `region`: from where the motion ends in the goal
- `sampling`, `tuning`: gains that satisfy the conditions and can be sampled
"""

from backhoe.lyapunov.candidate import (
    closed_loop_rate,
    closed_loop_state,
    derivative,
    derivative_terms,
    function,
)
from backhoe.lyapunov.certificate import Certificate, Condition, check_gains
from backhoe.lyapunov.conditions import matrix_condition
from backhoe.lyapunov.extremes import (
    Constants,
    Profile,
    christoffel,
    constants,
    gravity_slope,
    profile,
)
from backhoe.lyapunov.inequalities import (
    derivative_bound,
    derivative_term_bounds,
    lower_bound,
    quadratic_part,
    quadratic_term_bounds,
    quadratic_terms,
    rate_weights,
)
from backhoe.lyapunov.region import Attraction, attraction
from backhoe.lyapunov.sampling import effective_inertia, sampled_radius
from backhoe.lyapunov.tuning import Tuning, tune

__all__ = [
    "Attraction",
    "Certificate",
    "Condition",
    "Constants",
    "Profile",
    "Tuning",
    "attraction",
    "check_gains",
    "christoffel",
    "closed_loop_rate",
    "closed_loop_state",
    "constants",
    "derivative",
    "derivative_bound",
    "derivative_term_bounds",
    "derivative_terms",
    "effective_inertia",
    "function",
    "gravity_slope",
    "lower_bound",
    "matrix_condition",
    "profile",
    "quadratic_part",
    "quadratic_term_bounds",
    "quadratic_terms",
    "rate_weights",
    "sampled_radius",
    "tune",
]
