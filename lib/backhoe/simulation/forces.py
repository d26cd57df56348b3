"""All that pushes the machine in one step, as forces along its seven coordinates.

The coordinates are x, y, yaw of the vehicle and the four joints. Both backends integrate these same
forces: torques within the actuators' limits, joint friction, the stops at the ends of the joints'
range, the friction of the tracks, and the soil on the bucket's tip. SI units.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from backhoe.arm import dynamics
from backhoe.machine import Machine
from backhoe.simulation import tracks

COULOMB_SMOOTHING = 0.01
"""Speed below which Coulomb friction passes smoothly through zero [rad/s]."""

STOP_TRAVEL = 0.02
"""How far a stop gives under the joint's full torque [rad]: our choice, about one degree."""

STOP_DAMPING = 0.4
"""Damping ratio of a stop, with the smallest inertia that the joint can feel."""


def parameters(machine: Machine, friction: bool) -> NDArray:
    """The machine's numbers as the one record that the compiled functions read, shape (1,)."""
    boom, stick, bucket = machine.links
    base, swing, track = machine.base, machine.swing, machine.tracks
    scalars = {
        "base_offset": base.offset,
        "swing_offset": swing.offset,
        "boom_height": base.height + swing.height,
        "machine_mass": machine.mass,
        "payload": 0.0,
        "gravity": machine.gravity,
        "belt_speed": track.max_speed,
        "belt_acceleration": track.acceleration,
        "along": track.friction_longitudinal,
        "across": track.friction_lateral,
        "rolling": track.rolling_resistance,
        "belt_mass": track.belt_mass,
        "max_traction": track.max_traction,
    }
    for name, link in (("boom", boom), ("stick", stick), ("bucket", bucket)):
        scalars |= {
            f"{name}_length": link.length,
            f"{name}_angle_offset": link.angle_offset,
        }
    stiffness, damping = _stops(machine)
    vectors = {
        "lower": machine.lower,
        "upper": machine.upper,
        "torque_limit": machine.torque_limit,
        "viscous": machine.viscous * friction,
        "coulomb": machine.coulomb * friction,
        "stop_stiffness": stiffness,
        "stop_damping": damping,
    }
    fields = [(name, "f8") for name in scalars] + [(name, "f8", (4,)) for name in vectors]
    record = np.zeros(1, dtype=fields)
    for name, value in (scalars | vectors).items():
        record[name][0] = value
    return record


def _stops(machine: Machine) -> tuple[NDArray, NDArray]:
    """Stiffness [N m/rad] and damping [N m s/rad] of the stops, each of shape (4,)."""
    ranges = np.linspace(machine.lower, machine.upper, 7).T
    grid = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1)
    mobility = np.linalg.inv(dynamics.mass_matrix(grid, machine=machine))
    inertia = 1 / np.diagonal(mobility, axis1=-2, axis2=-1).max(axis=(0, 1, 2, 3))
    stiffness = machine.torque_limit / STOP_TRAVEL
    return stiffness, 2 * STOP_DAMPING * np.sqrt(stiffness * inertia)


@njit(cache=True)
def push(
    q,
    dq,
    torque,
    belt_command,
    soil,
    dt,
    parameters,
    patches,
    sheared,
    belts,
    pull,
    applied,
    out,
):
    """Forces along the seven coordinates over one step.

    Args:
        q, dq: coordinates x, y, yaw, swing, boom, stick, bucket and their rates, shape (7,).
        torque: wanted joint torques, shape (4,) [N m].
        belt_command: wanted speed of the left and right belt, shape (2,) [m/s].
        soil: force on the bucket's tip in the world [N] and moment raising its pitch [N m], (4,).
        dt: step [s].
        parameters: from `parameters`.
        patches: from `tracks.patch_positions`.
        sheared, belts: state of the tracks, brought forward in place.
        pull: forward force of the ground on the left and right track, shape (2,) [N], filled in.
        applied: the joint torques within the actuators' limits, shape (4,), filled in.
        out: the forces, shape (7,) [N, N, N m, ...], filled in.

    Returns:
        False, with nothing changed, if a torque or belt speed is not finite.
    """
    if not (np.isfinite(torque).all() and np.isfinite(belt_command).all()):
        return False
    p = parameters[0]
    _joint_torques(q, dq, torque, p, applied, out)
    _tip_force(q, soil, p, out)
    tracks.run_belts(belts, belt_command, p.belt_speed, p.belt_acceleration, dt)
    _ground_force(q, dq, soil, dt, p, patches, sheared, belts, pull, out)
    return True


@njit(cache=True)
def drive(
    q, dq, torque, traction, soil, dt, parameters, patches, sheared, belts, pull, applied, out
):
    """Forces along the seven coordinates over one step in which forces drive the belts.

    Args:
        traction: wanted force of the left and right drive, shape (2,) [N]; replaced by what the
            drives give.
        The others as for `push`.

    Returns:
        False, with nothing changed, if a torque or traction is not finite.
    """
    if not (np.isfinite(torque).all() and np.isfinite(traction).all()):
        return False
    p = parameters[0]
    _joint_torques(q, dq, torque, p, applied, out)
    _tip_force(q, soil, p, out)
    weight = _ground_force(q, dq, soil, dt, p, patches, sheared, belts, pull, out)
    tracks.drive_belts(
        belts, traction, pull, weight, p.rolling, p.belt_mass, p.max_traction, p.belt_speed, dt
    )
    return True


@njit(cache=True)
def _ground_force(q, dq, soil, dt, p, patches, sheared, belts, pull, out):
    """Force of the ground on the tracks, into out[:3]; returns the weight on the tracks [N]."""
    mass = p.machine_mass + p.payload
    weight = mass * p.gravity - soil[2]
    cos_yaw, sin_yaw = np.cos(q[2]), np.sin(q[2])
    velocity = dq[0] * cos_yaw + dq[1] * sin_yaw, dq[1] * cos_yaw - dq[0] * sin_yaw
    along, across, moment = tracks.shear(
        patches, weight, belts, velocity, dq[2], p.along, p.across, dt, sheared, pull
    )
    out[0] += along * cos_yaw - across * sin_yaw
    out[1] += along * sin_yaw + across * cos_yaw
    out[2] += moment
    return weight


@njit(cache=True)
def tip_motion(q, dq, parameters):
    """Pose and velocity of the bucket's tip frame in the world.

    Args:
        q, dq: coordinates x, y, yaw, swing, boom, stick, bucket and their rates, shape (7,).
        parameters: from `parameters`.

    Returns:
        T_world_tip, shape (4, 4), and the velocity of its origin, shape (3,) [m/s].
    """
    p = parameters[0]
    r2, z2, r3, z3, r4, z4, r, z, pitch = _arm_points(q, p)
    heading = q[2] + q[3] + np.pi / 2
    out_x, out_y = np.cos(heading), np.sin(heading)
    axis_x, axis_y = p.base_offset * np.cos(q[2]), p.base_offset * np.sin(q[2])
    c, s = np.cos(pitch), np.sin(pitch)
    T = np.zeros((4, 4))
    T[0, 0], T[1, 0], T[2, 0] = c * out_x, c * out_y, s
    T[0, 1], T[1, 1], T[2, 1] = -s * out_x, -s * out_y, c
    T[0, 2], T[1, 2] = out_y, -out_x
    T[0, 3], T[1, 3], T[2, 3] = q[0] + axis_x + r * out_x, q[1] + axis_y + r * out_y, z
    T[3, 3] = 1.0
    outwards = -((z - z2) * dq[4] + (z - z3) * dq[5] + (z - z4) * dq[6])
    turning = (dq[2] + dq[3]) * r
    velocity = np.array(
        [
            dq[0] - dq[2] * axis_y + outwards * out_x - turning * out_y,
            dq[1] + dq[2] * axis_x + outwards * out_y + turning * out_x,
            (r - r2) * dq[4] + (r - r3) * dq[5] + (r - r4) * dq[6],
        ]
    )
    return T, velocity


@njit(cache=True)
def _joint_torques(q, dq, torque, p, applied, out):
    """Actuator within its limit, friction and stop of each joint, into out[3:]."""
    for k in range(4):
        applied[k] = min(max(torque[k], -p.torque_limit[k]), p.torque_limit[k])
        friction = p.viscous[k] * dq[3 + k] + p.coulomb[k] * np.tanh(dq[3 + k] / COULOMB_SMOOTHING)
        out[3 + k] = applied[k] - friction + _stop(q[3 + k], dq[3 + k], k, p)


@njit(cache=True)
def _stop(angle, speed, k, p):
    """Torque of a stop: a spring and a damper that push back into the range and never pull."""
    if angle > p.upper[k]:
        return min(p.stop_stiffness[k] * (p.upper[k] - angle) - p.stop_damping[k] * speed, 0.0)
    if angle < p.lower[k]:
        return max(p.stop_stiffness[k] * (p.lower[k] - angle) - p.stop_damping[k] * speed, 0.0)
    return 0.0


@njit(cache=True)
def _arm_points(q, p):
    """Boom joint, stick joint, bucket pin and tip in the arm's plane, and the bucket's pitch.

    Each point is r outwards from the swing axis and z above the ground [m].
    """
    boom = q[4] + p.boom_angle_offset
    stick = boom + q[5] + p.stick_angle_offset
    bucket = stick + q[6] + p.bucket_angle_offset
    r2, z2 = p.swing_offset, p.boom_height
    r3, z3 = r2 + p.boom_length * np.cos(boom), z2 + p.boom_length * np.sin(boom)
    r4, z4 = r3 + p.stick_length * np.cos(stick), z3 + p.stick_length * np.sin(stick)
    r5, z5 = r4 + p.bucket_length * np.cos(bucket), z4 + p.bucket_length * np.sin(bucket)
    return r2, z2, r3, z3, r4, z4, r5, z5, bucket


@njit(cache=True)
def _tip_force(q, force, p, out):
    """J^T of a force and moment of the soil at the tip, into out."""
    r2, z2, r3, z3, r4, z4, r, z, _ = _arm_points(q, p)
    heading = q[2] + q[3] + np.pi / 2
    out_x, out_y = np.cos(heading), np.sin(heading)
    x = p.base_offset * np.cos(q[2]) + r * out_x
    y = p.base_offset * np.sin(q[2]) + r * out_y
    outwards = force[0] * out_x + force[1] * out_y
    out[0] = force[0]
    out[1] = force[1]
    out[2] = x * force[1] - y * force[0]
    out[3] += r * (force[1] * out_x - force[0] * out_y)
    out[4] += (r - r2) * force[2] - (z - z2) * outwards + force[3]
    out[5] += (r - r3) * force[2] - (z - z3) * outwards + force[3]
    out[6] += (r - r4) * force[2] - (z - z4) * outwards + force[3]
