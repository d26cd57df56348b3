"""Dynamic movement primitives: a demonstration as a spring, a phase and a learnt force.

- `phase`: the clock; `kernels`: the learnt function; `spring`: what it pulls, and its integrators
- `demonstrations`: an operator's; `motion`: with velocities; `primitive`: what learns from them
- `remedies`: better ways to new goals; `rhythmic`: a primitive that repeats
- `couplings`: obstacles and limits, which push it aside
- `library`: primitives by name, in files, one after the other
- `loops`: their loops, written once; `engine`: the same, compiled
"""

from backhoe.planning.dmp.couplings import keep_clear, keep_within
from backhoe.planning.dmp.demonstrations import (
    Demonstration,
    demonstration,
    recorded,
    repetitions,
)
from backhoe.planning.dmp.kernels import Kernels
from backhoe.planning.dmp.library import Library, sequence
from backhoe.planning.dmp.motion import Motion, motion
from backhoe.planning.dmp.phase import END_PHASE, minimum_jerk, phase, phase_rate
from backhoe.planning.dmp.primitive import DMP, FORMULATIONS
from backhoe.planning.dmp.remedies import REMEDIES
from backhoe.planning.dmp.rhythmic import Rhythmic
from backhoe.planning.dmp.spring import INTEGRATORS, step_limit, step_matrix

__all__ = [
    "DMP",
    "END_PHASE",
    "FORMULATIONS",
    "INTEGRATORS",
    "REMEDIES",
    "Demonstration",
    "Kernels",
    "Library",
    "Motion",
    "Rhythmic",
    "demonstration",
    "keep_clear",
    "keep_within",
    "minimum_jerk",
    "motion",
    "phase",
    "phase_rate",
    "recorded",
    "repetitions",
    "sequence",
    "step_limit",
    "step_matrix",
]
