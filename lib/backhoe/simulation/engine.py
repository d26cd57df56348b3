"""The laws of `forces`, `servo`, `pid_law`, `tracks`, `moving_base` and `standing`, compiled.

They run a thousand times a second. Give `push` its numbers as a plain tuple: Numba takes that over
faster.
"""

from __future__ import annotations

from backhoe.arm.dynamics import terms
from backhoe.basics.engine import compiled
from backhoe.simulation import forces, moving_base, pid_law, servo, standing, tracks
from backhoe.whole_body.stability import terms as stability_terms

push, tip_motion, balance, stand, speed_torque, hold, *_ = compiled(
    forces.push,
    forces.tip_motion,
    moving_base.balance,
    standing.stand,
    servo.speed_torque,
    pid_law.hold,
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
    standing.balance_in,
    standing.body_in,
    standing.arm_in,
    stability_terms.ground_reaction,
    stability_terms.joint_points,
)
