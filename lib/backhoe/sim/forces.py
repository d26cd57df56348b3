"""All that pushes the machine in one step, as forces along its seven coordinates.

The coordinates are x, y, yaw of the vehicle and the four joints. Both backends integrate these same
forces: torques within the actuators' limits, joint friction, the stops at the ends of the joints'
range, the friction of the tracks, and the soil on the bucket's tip. SI units.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from backhoe import dynamics
from backhoe.machine import Machine
from backhoe.sim import tracks

COULOMB_SMOOTHING = 0.01
"""Speed below which Coulomb friction passes smoothly through zero [rad/s]."""

STOP_TRAVEL = 0.02
"""How far a stop gives under the joint's full torque [rad]: our choice, about one degree."""

STOP_DAMPING = 0.4
"""Damping ratio of a stop, with the smallest inertia that the joint can feel."""

SOIL_TRAVEL = 0.005
"""Travel of the tip over which the soil's resistance builds up or turns round [m]: our choice."""

SOIL_RELAXATION = 0.002
"""Damping of the soil under the tip as a time [s]: our choice, it ends ringing of the bucket."""


def parameters(machine: Machine, friction: bool) -> NDArray:
    """The machine's numbers as the one record that the compiled functions read, shape (1,)."""
    boom, stick, bucket = machine.links
    base, swing, track = machine.base, machine.swing, machine.tracks
    scalars = {
        "base_offset": base.offset,
        "swing_offset": swing.offset,
        "boom_height": base.height + swing.height,
        "house_com_x": swing.com_radius * np.cos(swing.com_angle),
        "house_com_y": swing.com_radius * np.sin(swing.com_angle),
        "track_mass": track.mass,
        "house_mass": swing.mass,
        "payload": 0.0,
        "gravity": machine.gravity,
        "belt_speed": track.max_speed,
        "belt_acceleration": track.acceleration,
        "along": track.friction_longitudinal,
        "across": track.friction_lateral,
    }
    for name, link in (("boom", boom), ("stick", stick), ("bucket", bucket)):
        scalars |= {
            f"{name}_length": link.length,
            f"{name}_mass": link.mass,
            f"{name}_com_radius": link.com_radius,
            f"{name}_com_angle": link.com_angle,
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
    grid = np.stack(
        np.meshgrid(*(np.linspace(low, high, 7) for low, high in zip(machine.lower, machine.upper, strict=True)),
                    indexing="ij"), -1).reshape(-1, 4)
    mobility = np.linalg.inv(dynamics.mass_matrix(grid, machine=machine))
    inertia = 1 / np.diagonal(mobility, axis1=-2, axis2=-1).max(axis=0)
    stiffness = machine.torque_limit / STOP_TRAVEL
    return stiffness, 2 * STOP_DAMPING * np.sqrt(stiffness * inertia)


@njit(cache=True)
def push(
    q,
    dq,
    torque,
    belt_command,
    dt,
    parameters,
    patches,
    soil,
    sheared,
    loads,
    belts,
    dug,
    felt,
    applied,
    out,
):
    """Forces along the seven coordinates over one step.

    Args:
        q, dq: coordinates x, y, yaw, swing, boom, stick, bucket and their rates, shape (7,).
        torque: wanted joint torques, shape (4,) [N m].
        belt_command: wanted speed of the left and right belt, shape (2,) [m/s].
        dt: step [s].
        parameters: from `parameters`.
        patches: from `tracks.patch_positions`.
        soil: resistance of the soil [N] and the direction of motion that it was found for, (2, 3).
        sheared, loads, belts: state of the tracks, brought forward in place.
        dug: how far the soil's resistance has built up, shape (3,), brought forward in place.
        felt: force of the soil on the tip in the world frame, shape (3,) [N], filled in.
        applied: the joint torques within the actuators' limits, shape (4,), filled in.
        out: the forces, shape (7,) [N, N, N m, ...], filled in.

    Returns:
        False, with nothing changed, if a torque or belt speed is not finite.
    """
    if not (np.isfinite(torque).all() and np.isfinite(belt_command).all()):
        return False
    p = parameters[0]
    for k in range(4):
        applied[k] = min(max(torque[k], -p.torque_limit[k]), p.torque_limit[k])
        speed = dq[3 + k]
        out[3 + k] = (
            applied[k]
            - p.viscous[k] * speed
            - p.coulomb[k] * np.tanh(speed / COULOMB_SMOOTHING)
            + _stop(q[3 + k], speed, p.lower[k], p.upper[k], p.stop_stiffness[k], p.stop_damping[k])
        )
    out[:3] = 0.0

    yaw, yaw_rate = q[2], dq[2]
    forward = np.cos(yaw), np.sin(yaw)
    heading = yaw + q[3] + np.pi / 2
    outward = np.cos(heading), np.sin(heading)
    turning = yaw_rate + dq[3]
    boom = q[4] + p.boom_angle_offset
    stick = boom + q[5] + p.stick_angle_offset
    bucket = stick + q[6] + p.bucket_angle_offset
    r2, z2 = p.swing_offset, p.boom_height
    r3, z3 = r2 + p.boom_length * np.cos(boom), z2 + p.boom_length * np.sin(boom)
    r4, z4 = r3 + p.stick_length * np.cos(stick), z3 + p.stick_length * np.sin(stick)
    rt, zt = r4 + p.bucket_length * np.cos(bucket), z4 + p.bucket_length * np.sin(bucket)
    tip_x = p.base_offset * forward[0] + rt * outward[0]
    tip_y = p.base_offset * forward[1] + rt * outward[1]

    fx, fy, fz = 0.0, 0.0, 0.0
    if soil[0, 0] != 0.0 or soil[0, 1] != 0.0 or soil[0, 2] != 0.0:
        away = -((zt - z2) * dq[4] + (zt - z3) * dq[5] + (zt - z4) * dq[6])
        up = (rt - r2) * dq[4] + (rt - r3) * dq[5] + (rt - r4) * dq[6]
        vx = dq[0] - yaw_rate * p.base_offset * forward[1] + away * outward[0] - turning * rt * outward[1]
        vy = dq[1] + yaw_rate * p.base_offset * forward[0] + away * outward[1] + turning * rt * outward[0]
        fx, fy, fz = _resistance(soil, vx, vy, up, dt, dug)
        radial = fx * outward[0] + fy * outward[1]
        out[0] += fx
        out[1] += fy
        out[2] += tip_x * fy - tip_y * fx
        out[3] += rt * (fy * outward[0] - fx * outward[1])
        out[4] += (rt - r2) * fz - (zt - z2) * radial
        out[5] += (rt - r3) * fz - (zt - z3) * radial
        out[6] += (rt - r4) * fz - (zt - z4) * radial
    else:
        dug[:] = 0.0
    felt[0], felt[1], felt[2] = fx, fy, fz

    boom_com = r2 + p.boom_com_radius * np.cos(q[4] + p.boom_com_angle)
    stick_com = r3 + p.stick_com_radius * np.cos(boom + q[5] + p.stick_com_angle)
    bucket_com = r4 + p.bucket_com_radius * np.cos(stick + q[6] + p.bucket_com_angle)
    bucket_mass = p.bucket_mass + p.payload
    arm = p.boom_mass * boom_com + p.stick_mass * stick_com + bucket_mass * bucket_com
    house_arm_mass = p.house_mass + p.boom_mass + p.stick_mass + bucket_mass
    swing = q[3] + np.pi / 2
    moment_out = arm + p.house_mass * p.house_com_x
    moment_left = p.house_mass * p.house_com_y
    moment_x = house_arm_mass * p.base_offset + moment_out * np.cos(swing) - moment_left * np.sin(swing)
    moment_y = moment_out * np.sin(swing) + moment_left * np.cos(swing)
    weight = (house_arm_mass + p.track_mass) * p.gravity - fz
    if weight > 0.0:
        push_x, push_y = fx * forward[0] + fy * forward[1], fy * forward[0] - fx * forward[1]
        at_x, at_y = tip_x * forward[0] + tip_y * forward[1], tip_y * forward[0] - tip_x * forward[1]
        centre_x = (moment_x * p.gravity + zt * push_x - at_x * fz) / weight
        centre_y = (moment_y * p.gravity + zt * push_y - at_y * fz) / weight
        tracks.patch_loads(patches, weight, centre_x, centre_y, loads)
    else:
        loads[:] = 0.0
    tracks.run_belts(belts, belt_command, p.belt_speed, p.belt_acceleration, dt)
    velocity = dq[0] * forward[0] + dq[1] * forward[1], dq[1] * forward[0] - dq[0] * forward[1]
    ground_x, ground_y, ground_moment = tracks.friction(
        patches, loads, belts, velocity, yaw_rate, p.along, p.across, dt, sheared
    )
    out[0] += ground_x * forward[0] - ground_y * forward[1]
    out[1] += ground_x * forward[1] + ground_y * forward[0]
    out[2] += ground_moment
    return True


@njit(cache=True)
def _stop(angle, speed, lower, upper, stiffness, damping):
    """Torque of a stop: a spring and a damper that push back into the range and never pull."""
    if angle > upper:
        return min(-stiffness * (angle - upper) - damping * speed, 0.0)
    if angle < lower:
        return max(stiffness * (lower - angle) - damping * speed, 0.0)
    return 0.0


@njit(cache=True)
def _resistance(soil, vx, vy, vz, dt, dug):
    """Force of the soil on the tip, built up over `SOIL_TRAVEL` like a spring that yields.

    Between two visits to the soil its largest resistance is held; moving on, the tip feels all of
    it, resting it keeps what is balanced, turning back it first lets go. Nothing jumps.
    """
    velocity = vx, vy, vz
    largest = np.sqrt(soil[0, 0] ** 2 + soil[0, 1] ** 2 + soil[0, 2] ** 2)
    size = 0.0
    for axis in range(3):
        dug[axis] += velocity[axis] * dt / SOIL_TRAVEL
        size += dug[axis] ** 2
    size = max(np.sqrt(size), 1.0)
    for axis in range(3):
        dug[axis] /= size
    strain = dug[0], dug[1], dug[2]
    sx = strain[0] + vx * SOIL_RELAXATION / SOIL_TRAVEL
    sy = strain[1] + vy * SOIL_RELAXATION / SOIL_TRAVEL
    sz = strain[2] + vz * SOIL_RELAXATION / SOIL_TRAVEL
    size = max(np.sqrt(sx**2 + sy**2 + sz**2), 1.0)
    sx, sy, sz = sx / size, sy / size, sz / size
    dx, dy, dz = soil[1, 0], soil[1, 1], soil[1, 2]
    onward = sx * dx + sy * dy + sz * dz
    return (
        soil[0, 0] * onward - largest * (sx - onward * dx),
        soil[0, 1] * onward - largest * (sy - onward * dy),
        soil[0, 2] * onward - largest * (sz - onward * dz),
    )


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
    yaw, heading = q[2], q[2] + q[3] + np.pi / 2
    out_x, out_y = np.cos(heading), np.sin(heading)
    boom = q[4] + p.boom_angle_offset
    stick = boom + q[5] + p.stick_angle_offset
    pitch = stick + q[6] + p.bucket_angle_offset
    r2, z2 = p.swing_offset, p.boom_height
    r3, z3 = r2 + p.boom_length * np.cos(boom), z2 + p.boom_length * np.sin(boom)
    r4, z4 = r3 + p.stick_length * np.cos(stick), z3 + p.stick_length * np.sin(stick)
    r, z = r4 + p.bucket_length * np.cos(pitch), z4 + p.bucket_length * np.sin(pitch)
    axis_x, axis_y = p.base_offset * np.cos(yaw), p.base_offset * np.sin(yaw)
    c, s = np.cos(pitch), np.sin(pitch)
    T = np.zeros((4, 4))
    T[0, 0], T[1, 0], T[2, 0] = c * out_x, c * out_y, s
    T[0, 1], T[1, 1], T[2, 1] = -s * out_x, -s * out_y, c
    T[0, 2], T[1, 2] = out_y, -out_x
    T[0, 3], T[1, 3], T[2, 3] = q[0] + axis_x + r * out_x, q[1] + axis_y + r * out_y, z
    T[3, 3] = 1.0
    away = -((z - z2) * dq[4] + (z - z3) * dq[5] + (z - z4) * dq[6])
    up = (r - r2) * dq[4] + (r - r3) * dq[5] + (r - r4) * dq[6]
    turning = dq[2] + dq[3]
    velocity = np.zeros(3)
    velocity[0] = dq[0] - dq[2] * axis_y + away * out_x - turning * r * out_y
    velocity[1] = dq[1] + dq[2] * axis_x + away * out_y + turning * r * out_x
    velocity[2] = up
    return T, velocity
