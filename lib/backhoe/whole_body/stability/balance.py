"""Does it stand? Centre of mass, zero-moment point and the distance to the nearest edge."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.dynamics.postures import posture
from backhoe.arm.dynamics.terms import Arm, Vectors, arm_of
from backhoe.arm.kinematics.forward import joint_vector, leading_shape
from backhoe.basics.inputs import instance, numbers
from backhoe.machine import BACKHOE, Machine
from backhoe.whole_body.stability.polygon import EDGES, distances, support_polygon
from backhoe.whole_body.stability.terms import (
    Motion,
    Pull,
    body_of,
    ground_reaction,
    joint_points,
    zero_moment,
)

STILL = np.zeros(4)
FASTEST = 1e6
"""Rates above it are refused, since their squares may have no number [rad/s]."""


class Margin(NamedTuple):
    """How far inside the nearest edge the ground carries the machine [m], and that edge's name.

    Both of shape (...), a number and a text for one posture. Negative: it tips over that edge.
    """

    distance: NDArray | float
    edge: NDArray | str


class Stance(NamedTuple):
    """A posture with its load, broadcast: what `ground_reaction` starts from."""

    arm: Arm
    v: Vectors
    out_x: NDArray
    out_y: NDArray


def centre_of_mass(q: ArrayLike, load: ArrayLike = 0.0, machine: Machine = BACKHOE) -> NDArray:
    """Centre of mass of the whole machine.

    Args:
        q: joint angles, shape (..., 4) [rad].
        load: mass at the bucket's centre of mass, shape (...) [kg].
        machine: its numbers.

    Returns:
        x, y, z in the vehicle's axes, z from the ground, shape (..., 3) [m].

    Raises:
        ValueError: a wrong shape, a value that is not finite, or a negative load.
    """
    stance = stand(joint_vector(q), _load(load), machine)
    body, (arm, v, out_x, out_y) = body_of(machine), stance
    r2, z2, r3, z3, r4, z4 = joint_points(arm, v)
    mass = body.m_u + body.m_t + arm.m_bo + arm.m_s + arm.m_bu
    moved = mass - body.m_u
    outward = body.m_t * body.ahead + arm.m_bo * r2 + arm.m_s * r3 + arm.m_bu * r4
    leftward = body.m_t * body.aside
    x = moved * body.offset + outward * out_x - leftward * out_y
    y = outward * out_y + leftward * out_x
    z = body.m_u * body.z_u + body.m_t * body.z_t + arm.m_bo * z2 + arm.m_s * z3 + arm.m_bu * z4
    return np.stack(np.broadcast_arrays(x, y, z), axis=-1) / np.asarray(mass)[..., None]


def centre_of_mass_jacobian(
    q: ArrayLike, load: ArrayLike = 0.0, machine: Machine = BACKHOE
) -> NDArray:
    """How the centre of mass of the whole machine moves with the joints.

    Args:
        q, load, machine: as for `centre_of_mass`.

    Returns:
        J with velocity J @ dq in the vehicle's axes, shape (..., 3, 4) [m/rad].

    Raises:
        ValueError: as for `centre_of_mass`.
    """
    arm, v, out_x, out_y = stand(joint_vector(q), _load(load), machine)
    body, points = body_of(machine), joint_points(arm, v)
    r3, z3 = arm.b1 + v.l2r, arm.z1 + v.l2z
    r, z, r0, z0, masses = (
        np.stack(np.broadcast_arrays(*row, out_x)[:-1], axis=-1)
        for row in (
            points[::2],
            points[1::2],
            (arm.b1, r3, r3 + v.l3r),
            (arm.z1, z3, z3 + v.l3z),
            (arm.m_bo, arm.m_s, arm.m_bu),
        )
    )
    # A joint turns its own link and those after it: sums from the bucket inwards.
    m, mr, mz = (
        np.cumsum(x[..., ::-1], axis=-1)[..., ::-1] for x in (masses, masses * r, masses * z)
    )
    outward, leftward = body.m_t * body.ahead + mr[..., 0], body.m_t * body.aside
    J = np.zeros((*m.shape[:-1], 3, 4))
    J[..., 0, 0] = -outward * out_y - leftward * out_x
    J[..., 1, 0] = outward * out_x - leftward * out_y
    out = m * z0 - mz
    J[..., 0, 1:], J[..., 1, 1:] = out * out_x[..., None], out * out_y[..., None]
    J[..., 2, 1:] = mr - m * r0
    return J / (body.m_u + body.m_t + m[..., :1, None])


def zero_moment_point(
    q: ArrayLike,
    dq: ArrayLike = STILL,
    ddq: ArrayLike = STILL,
    *,
    load: ArrayLike = 0.0,
    yaw_rate: ArrayLike = 0.0,
    acceleration: ArrayLike = (0.0, 0.0, 0.0),
    soil: ArrayLike = STILL,
    slope: ArrayLike = 0.0,
    uphill: ArrayLike = 0.0,
    machine: Machine = BACKHOE,
) -> NDArray:
    """Where the ground carries the machine: there its force has no moment about level axes.

    At rest on level ground this is the point under the centre of mass. What is accelerated pushes
    it away, what the soil carries at the bucket moves it to the other side.

    Args:
        q, dq, ddq: joint angles, rates and accelerations, shape (..., 4) [rad, rad/s, rad/s^2].
        load: mass at the bucket's centre of mass, shape (...) [kg].
        yaw_rate: of the vehicle, shape (...) [rad/s].
        acceleration: of the vehicle's origin along its own x and y, and of its yaw, shape (..., 3)
            [m/s^2, m/s^2, rad/s^2].
        soil: force of the soil at the bucket's tip along the vehicle's axes, and its moment that
            raises the bucket's pitch, shape (..., 4) [N, N, N, N m].
        slope, uphill: of the ground, as for `gravity_on_slope`, shape (...) [rad].
        machine: its numbers.

    Returns:
        x, y in the vehicle's axes, shape (..., 2) [m].

    Raises:
        ValueError: a wrong shape, a value that is not finite, a negative load, a slope on which the
            tracks slip, or a soil that lifts the machine off the ground.
    """
    q, dq, ddq = joint_vector(q), joint_vector(dq, "dq"), joint_vector(ddq, "ddq")
    load, omega = _load(load), numbers(yaw_rate, "yaw_rate", within=FASTEST)
    numbers(dq, "dq", within=FASTEST)
    meaning = "ahead, to the left [m/s^2] and of the yaw [rad/s^2]"
    moved = numbers(acceleration, "acceleration", (..., 3), meaning=meaning)
    soil = numbers(soil, "soil", (..., 4), meaning="force [N] and moment [N m] of the soil")
    gravity = gravity_on_slope(slope, uphill, machine)
    leading_shape(q, dq, ddq, load[..., None], omega[..., None], moved, soil, gravity)
    stance = stand(q, load, machine)
    (ax, ay, alpha), down, push = (np.moveaxis(a, -1, 0) for a in (moved, gravity, soil))
    rates, changes = np.moveaxis(dq, -1, 0), np.moveaxis(ddq, -1, 0)
    pitch, dpitch = np.cumsum(rates[1:], axis=0), np.cumsum(changes[1:], axis=0)
    motion = Motion(rates[0] + omega, changes[0] + alpha, *pitch, *dpitch, omega, alpha, ax, ay)
    pull = Pull(*down, *push, *_tip(stance, q, machine))
    reaction = ground_reaction(body_of(machine), *stance, motion, pull)
    if not (np.asarray(reaction.fz) > 0).all():
        raise ValueError(
            "soil must leave weight on the tracks, got a force that lifts the machine: the ground "
            f"would have to pull with {-np.min(reaction.fz) / 1e3:.1f} kN"
        )
    return np.stack(np.broadcast_arrays(*zero_moment(reaction)), axis=-1)


def margin(
    q: ArrayLike,
    dq: ArrayLike = STILL,
    ddq: ArrayLike = STILL,
    *,
    machine: Machine = BACKHOE,
    **pushed: ArrayLike,
) -> Margin:
    """Distance from the zero-moment point to the nearest edge: static at rest, else dynamic.

    Args:
        q, dq, ddq, machine: as for `zero_moment_point`.
        pushed: load, yaw_rate, acceleration, soil, slope and uphill, as for `zero_moment_point`.

    Returns:
        The `Margin`, of shape (...) [m].

    Raises:
        ValueError: as for `zero_moment_point`.
    """
    point = zero_moment_point(q, dq, ddq, machine=machine, **pushed)
    inside = distances(point, support_polygon(machine))
    names = np.array(EDGES)[inside.argmin(axis=-1)]
    return Margin(inside.min(axis=-1)[()], str(names) if names.ndim == 0 else names)


def gravity_on_slope(
    slope: ArrayLike, uphill: ArrayLike = 0.0, machine: Machine = BACKHOE
) -> NDArray:
    """Gravity along the axes of a vehicle that stands on a slope.

    Args:
        slope: of the ground, from level, 0 or more, shape (...) [rad].
        uphill: direction in which the ground rises, counted from the nose to the left, shape (...)
            [rad]: 0 with the nose uphill, pi / 2 with the left track uphill.
        machine: whose gravity and friction count.

    Returns:
        Components x, y, z, shape (..., 3) [m/s^2].

    Raises:
        ValueError: a value is not finite, a slope is negative, or so steep that the tracks slip.
    """
    slope, uphill = numbers(slope, "slope"), numbers(uphill, "uphill")
    leading_shape(slope[..., None], uphill[..., None])
    slope, uphill = np.broadcast_arrays(slope, uphill)
    c, s = np.cos(uphill), np.sin(uphill)
    tracks = instance(machine, "machine", Machine).tracks
    grip = 1 / np.hypot(c / tracks.friction_longitudinal, s / tracks.friction_lateral)
    excess = np.maximum(slope - np.arctan(grip), -slope)
    if (excess > 0).any():
        at = np.unravel_index(excess.argmax(), excess.shape)
        raise ValueError(
            f"slope must be from 0 to {np.degrees(np.arctan(grip[at])):.1f} deg, from where on the "
            f"tracks slip in this direction, got {np.degrees(slope[at]):.1f} deg"
        )
    down = np.sin(slope)
    return machine.gravity * np.stack([-down * c, -down * s, -np.cos(slope)], axis=-1)


def stand(q: NDArray, load: NDArray, machine: Machine) -> Stance:
    """The stance of checked joint angles (..., 4) [rad] and load (...) [kg]."""
    arm = arm_of(instance(machine, "machine", Machine))
    arm = arm._replace(m_bu=arm.m_bu + load)
    v = posture(arm, np.moveaxis(q, -1, 0), np.cos, np.sin)
    heading = q[..., 0] + np.pi / 2
    return Stance(arm, v, np.cos(heading), np.sin(heading))


def _tip(stance: Stance, q: NDArray, machine: Machine) -> tuple[NDArray, NDArray]:
    """The bucket's tip, outwards from the swing axis and above the ground [m]."""
    arm, v = stance.arm, stance.v
    pitch = q[..., 1:].sum(axis=-1) + arm.o2 + arm.o3 + arm.o4
    r = arm.b1 + v.l2r + v.l3r + machine.bucket.length * np.cos(pitch)
    return r, arm.z1 + v.l2z + v.l3z + machine.bucket.length * np.sin(pitch)


def _load(load: ArrayLike) -> NDArray:
    load = numbers(load, "load", meaning="masses in the bucket [kg]")
    if (load < 0).any():
        raise ValueError(f"load must be 0 or more [kg], got {load.min():g}")
    return load
