"""All that pushes the machine in one step, as forces along its seven coordinates.

The coordinates are x, y, yaw of the vehicle and the four joints. Both backends integrate these same
forces: torques within the actuators' limits, joint friction, the stops at the ends of the joints'
range, the friction of the tracks, and the soil on the bucket's tip. SI units. `engine` has the same
functions compiled.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from backhoe.arm import dynamics
from backhoe.machine import Machine
from backhoe.simulation.tracks import drive_belts, patch_positions, run_belts, shear

COULOMB_SMOOTHING = 0.01
"""Speed below which Coulomb friction passes smoothly through zero [rad/s]."""

STOP_TRAVEL = 0.02
"""How far a stop gives under the joint's full torque [rad]: our choice, about one degree."""

STOP_DAMPING = 0.4
"""Damping ratio of a stop, with the smallest inertia that the joint can feel."""


class Numbers(NamedTuple):
    """What the forces need of a machine, in arrays: so they pass fastest into compiled code.

    Attributes:
        reach: offset of the swing axis from the vehicle's origin and of the boom's joint from that,
            height of that joint, lengths of boom, stick and bucket [m], their angle offsets [rad],
            shape (9,).
        joints: rows lower and upper limit [rad], torque limit [N m], viscous [N m s/rad] and
            Coulomb friction [N m], stiffness [N m/rad] and damping [N m s/rad] of the stops,
            shape (7, 4).
        patches: as in `tracks.patch_positions`, shape (n, 2) [m].
        friction: coefficients along and across the belts, shape (2,) [1].
        belt: its mass [kg], rolling resistance over weight, largest driving force [N], speed [m/s]
            and acceleration [m/s^2], shape (5,).
        load: mass of the empty machine and of the soil in the bucket [kg], gravity [m/s^2], (3,).
    """

    reach: NDArray
    joints: NDArray
    patches: NDArray
    friction: NDArray
    belt: NDArray
    load: NDArray


class State(NamedTuple):
    """What a step changes in place: views of one memory, which alone passes into compiled code.

    Attributes:
        q, dq: coordinates x, y, yaw, swing, boom, stick, bucket and their rates, shape (7,).
        soil: force on the bucket's tip in the world [N] and moment raising its pitch [N m], (4,).
        belts: speed of the left and right belt, shape (2,) [m/s].
        traction: what drives of given force gave each track, shape (2,) [N].
        torque: what the actuators gave the joints, shape (4,) [N m].
        forces: along the seven coordinates, shape (7,) [N, N, N m, ...].
        sheared: of each patch, as in `tracks.shear`, shape (n, 2).
    """

    q: NDArray
    dq: NDArray
    soil: NDArray
    belts: NDArray
    traction: NDArray
    torque: NDArray
    forces: NDArray
    sheared: NDArray


def numbers_of(machine: Machine, friction: bool) -> Numbers:
    """A machine's numbers; its joints without friction if not `friction`."""
    base, swing, tracks, links = machine.base, machine.swing, machine.tracks, machine.links
    frame = base.offset, swing.offset, base.height + swing.height
    loss = machine.viscous * friction, machine.coulomb * friction
    arrays = (
        [*frame, *(link.length for link in links), *(link.angle_offset for link in links)],
        [machine.lower, machine.upper, machine.torque_limit, *loss, *_stops(machine)],
        patch_positions(machine),
        [tracks.friction_longitudinal, tracks.friction_lateral],
        [
            tracks.belt_mass,
            tracks.rolling_resistance,
            tracks.max_traction,
            tracks.max_speed,
            tracks.acceleration,
        ],
        [machine.mass, 0.0, machine.gravity],
    )
    return Numbers(*(np.array(array, dtype=float) for array in arrays))


def _stops(machine: Machine) -> tuple[NDArray, NDArray]:
    """Stiffness [N m/rad] and damping [N m s/rad] of the stops, each of shape (4,)."""
    ranges = np.linspace(machine.lower, machine.upper, 7).T
    grid = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1)
    mobility = np.linalg.inv(dynamics.mass_matrix(grid, machine=machine))
    inertia = 1 / np.diagonal(mobility, axis1=-2, axis2=-1).max(axis=(0, 1, 2, 3))
    stiffness = machine.torque_limit / STOP_TRAVEL
    return stiffness, 2 * STOP_DAMPING * np.sqrt(stiffness * inertia)


def memory_of(numbers: Numbers) -> NDArray:
    """Of a machine at the origin, at rest, its joints at zero, shape (33 + 2 n,) [own units]."""
    return np.zeros(33 + numbers.patches.size)


def state_in(memory):
    """The `State` in a memory."""
    return State(
        memory[:7],
        memory[7:14],
        memory[14:18],
        memory[18:20],
        memory[20:22],
        memory[22:26],
        memory[26:33],
        memory[33:].reshape(-1, 2),
    )


def push(numbers, memory, torque, command, driven, dt):
    """Find the forces along the seven coordinates over one step, and move the belts.

    Args:
        numbers: a `Numbers`.
        memory: of the `State`; all but coordinates, rates and soil is brought forward in place.
        torque: wanted joint torques, shape (4,) [N m].
        command: of the left and right belt, shape (2,): wanted driving forces [N] if `driven`, else
            wanted speeds [m/s].
        driven: whether forces drive the belts.
        dt: step [s].

    Returns:
        False, with nothing changed, if a torque or command is not finite.
    """
    numbers, state = Numbers(*numbers), state_in(memory)
    if not (np.isfinite(torque).all() and np.isfinite(command).all()):
        return False
    joint_torques(numbers.joints, state, torque)
    tip_force(numbers.reach, state)
    if driven:
        weight, pull = ground_force(numbers, state, dt)
        state.traction[0], state.traction[1] = command[0], command[1]
        drive_belts(numbers.belt, state.belts, state.traction, pull, weight, dt)
    else:
        state.traction[:] = 0.0
        run_belts(numbers.belt, state.belts, command, dt)
        ground_force(numbers, state, dt)
    return True


def joint_torques(joints, state, torque):
    """Actuator within its limit, friction and stop of each joint, into state.forces[3:]."""
    lower, upper, limit, viscous, coulomb, stiffness, damping = joints
    for k in range(4):
        angle, speed = state.q[3 + k], state.dq[3 + k]
        state.torque[k] = min(max(torque[k], -limit[k]), limit[k])
        friction = viscous[k] * speed + coulomb[k] * np.tanh(speed / COULOMB_SMOOTHING)
        stop = 0.0  # a spring and a damper that push back into the range and never pull
        if angle > upper[k]:
            stop = min(stiffness[k] * (upper[k] - angle) - damping[k] * speed, 0.0)
        elif angle < lower[k]:
            stop = max(stiffness[k] * (lower[k] - angle) - damping[k] * speed, 0.0)
        state.forces[3 + k] = state.torque[k] - friction + stop


def ground_force(numbers, state, dt):
    """Add the force of the ground on the tracks to state.forces[:3].

    Returns:
        Weight on the tracks [N] and forward force of the ground on each, shape (2,) [N].
    """
    dq, out, (mass, payload, gravity) = state.dq, state.forces, numbers.load
    weight = (mass + payload) * gravity - state.soil[2]
    cos_yaw, sin_yaw = np.cos(state.q[2]), np.sin(state.q[2])
    twist = dq[0] * cos_yaw + dq[1] * sin_yaw, dq[1] * cos_yaw - dq[0] * sin_yaw, dq[2]
    (along, across, moment), pull = shear(numbers, weight, twist, state.belts, state.sheared, dt)
    out[0] += along * cos_yaw - across * sin_yaw
    out[1] += along * sin_yaw + across * cos_yaw
    out[2] += moment
    return weight, pull


def tip_motion(reach, q, dq):
    """Pose and velocity of the bucket's tip frame in the world.

    Args:
        reach: as in `Numbers`.
        q, dq: coordinates and rates as in `State`, shape (7,).

    Returns:
        T_world_tip, shape (4, 4), and the velocity of its origin, shape (3,) [m/s].
    """
    r2, z2, r3, z3, r4, z4, r, z, pitch = arm_points(reach, q)
    heading = q[2] + q[3] + np.pi / 2
    out_x, out_y = np.cos(heading), np.sin(heading)
    axis_x, axis_y = reach[0] * np.cos(q[2]), reach[0] * np.sin(q[2])
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


def arm_points(reach, q):
    """Boom joint, stick joint, bucket pin and tip in the arm's plane, and the bucket's pitch.

    Each point is r outwards from the swing axis and z above the ground [m].
    """
    _, r2, z2, L2, L3, L4, boom_offset, stick_offset, bucket_offset = reach
    boom = q[4] + boom_offset
    stick = boom + q[5] + stick_offset
    bucket = stick + q[6] + bucket_offset
    r3, z3 = r2 + L2 * np.cos(boom), z2 + L2 * np.sin(boom)
    r4, z4 = r3 + L3 * np.cos(stick), z3 + L3 * np.sin(stick)
    r5, z5 = r4 + L4 * np.cos(bucket), z4 + L4 * np.sin(bucket)
    return r2, z2, r3, z3, r4, z4, r5, z5, bucket


def tip_force(reach, state):
    """J^T of the force and moment of the soil at the tip, into state.forces."""
    q, force, out = state.q, state.soil, state.forces
    r2, z2, r3, z3, r4, z4, r, z, _ = arm_points(reach, q)
    heading = q[2] + q[3] + np.pi / 2
    out_x, out_y = np.cos(heading), np.sin(heading)
    x = reach[0] * np.cos(q[2]) + r * out_x
    y = reach[0] * np.sin(q[2]) + r * out_y
    outwards = force[0] * out_x + force[1] * out_y
    out[0] = force[0]
    out[1] = force[1]
    out[2] = x * force[1] - y * force[0]
    out[3] += r * (force[1] * out_x - force[0] * out_y)
    out[4] += (r - r2) * force[2] - (z - z2) * outwards + force[3]
    out[5] += (r - r3) * force[2] - (z - z3) * outwards + force[3]
    out[6] += (r - r4) * force[2] - (z - z4) * outwards + force[3]
