"""Lyapunov's method for the arm under PID: function, constants, certificates, gains.

- `candidate`: the closed loop, Kelly's function V and its derivative
- `extremes`: the constants k_g, k_C1 and the extreme eigenvalues of M
"""

from backhoe.lyapunov.candidate import (
    closed_loop_rate,
    closed_loop_state,
    derivative,
    derivative_terms,
    function,
)
from backhoe.lyapunov.extremes import (
    Constants,
    Profile,
    christoffel,
    constants,
    gravity_slope,
    profile,
)

__all__ = [
    "Constants",
    "Profile",
    "christoffel",
    "closed_loop_rate",
    "closed_loop_state",
    "constants",
    "derivative",
    "derivative_terms",
    "function",
    "gravity_slope",
    "profile",
]
