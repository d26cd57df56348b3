"""Dynamic movement primitives: a demonstration as a spring, a phase and a learnt force.

- `phase`: the clock; `kernels`: the learnt function; `spring`: what it pulls, and its integrators
- `demonstration`: what is learnt from; `primitive`: the DMP; `remedies`: better ways to new goals
- `loops`: their loops, written once; `engine`: the same, compiled
"""

from backhoe.planning.dmp.demonstration import Demonstration, demonstration
from backhoe.planning.dmp.kernels import Kernels
from backhoe.planning.dmp.phase import END_PHASE, minimum_jerk, phase, phase_rate
from backhoe.planning.dmp.primitive import DMP, FORMULATIONS
from backhoe.planning.dmp.remedies import REMEDIES
from backhoe.planning.dmp.spring import INTEGRATORS, step_limit, step_matrix

__all__ = [
    "DMP",
    "END_PHASE",
    "FORMULATIONS",
    "INTEGRATORS",
    "REMEDIES",
    "Demonstration",
    "Kernels",
    "demonstration",
    "minimum_jerk",
    "phase",
    "phase_rate",
    "step_limit",
    "step_matrix",
]
