"""Dynamics of the arm.

- `motion`: the equation of motion, forwards and backwards; M, C, g, friction and energy
- `terms`: the closed forms, each written once
- `engine`: the same, compiled, for hundreds of thousands of postures, loaded when first needed
"""

from backhoe.arm.dynamics.motion import (
    coriolis_matrix,
    energy,
    forward_dynamics,
    friction_torque,
    gravity_torque,
    inverse_dynamics,
    mass_matrix,
    mass_matrix_derivative,
)

__all__ = [
    "coriolis_matrix",
    "energy",
    "forward_dynamics",
    "friction_torque",
    "gravity_torque",
    "inverse_dynamics",
    "mass_matrix",
    "mass_matrix_derivative",
]
