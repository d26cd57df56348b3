"""The laws of `forces`, `tracks` and `moving_base`, compiled for a thousand steps a second.

Give `push` its numbers as a plain tuple: Numba takes that over faster.
"""

from __future__ import annotations

from backhoe.arm.dynamics import terms
from backhoe.basics.engine import compiled
from backhoe.simulation import forces, moving_base, tracks

push, tip_motion, balance, *_ = compiled(
    forces.push,
    forces.tip_motion,
    moving_base.balance,
    tracks.shear,
    tracks.run_belts,
    tracks.drive_belts,
    tracks.move_on,
    forces.joint_torques,
    forces.ground_force,
    forces.arm_points,
    forces.state_in,
    forces.tip_force,
    moving_base.vectors_at,
    terms.vectors,
    terms.inertias,
    terms.gravity_torques,
    terms.newton_euler,
)
