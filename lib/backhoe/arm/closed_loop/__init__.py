"""The arm under a joint controller, by the hundred: many closed loops along one movement.

The controller runs in samples and its torque is held in between, where the exact equation of motion
of `dynamics` is integrated by the Runge-Kutta rule of fourth order. Nothing but floating-point
rounding depends on how many runs go together, or on where they run.

- `runs`: one batch, on all cores of this machine
- `sweeps`: the same in chunks, with a progress bar, on whatever `joblib` is told to use
- `task`: what may go in
- `batch`: what comes out
- `plain`: the loop, one run at a time, to be read
- `engine`, `step_engine`: the same loop compiled, on the `rows` of a block of runs
"""

from backhoe.arm.closed_loop.batch import Batch, Trajectory
from backhoe.arm.closed_loop.runs import LARGEST_ERROR, LARGEST_SPEED, simulate
from backhoe.arm.closed_loop.sweeps import sweep
from backhoe.arm.closed_loop.task import COULOMB_SMOOTHING, LAWS

__all__ = [
    "COULOMB_SMOOTHING",
    "LARGEST_ERROR",
    "LARGEST_SPEED",
    "LAWS",
    "Batch",
    "Trajectory",
    "simulate",
    "sweep",
]
