"""Whether the machine stands, at every step: margin of its balance, and what would lift.

The base moves in the plane and cannot tilt, so the balance says what a machine on real ground
would do: the force of the ground that the motion needs must act inside the tracks' support polygon.
Beyond an edge for some milliseconds it lifts no track; so the tilt about each edge is followed as
that of a rigid body, and the machine counts as tipped when the far side would be `LIFT` in the air.
A machine that lifts itself on its bucket ends there, too: the base cannot follow it.
The balance itself is that of `whole_body.stability`. `engine` has the same functions compiled.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.dynamics.terms import Arm, arm_of, vectors
from backhoe.machine import Machine
from backhoe.whole_body import stability
from backhoe.whole_body.stability.terms import (
    Body,
    Motion,
    Pull,
    body_of,
    ground_reaction,
    joint_points,
)

LIFT = 0.05
"""How far the far side of the tracks is off the ground when the machine counts as tipped [m]."""

NOTICED = 1e-6
"""By how much a margin must be less to count as the least [m]: rounding must not decide when."""


class Least(NamedTuple):
    """The least margin so far [m], when [s] and to which edge."""

    margin: float
    time: float
    edge: str


class Tipped(RuntimeError):
    """The machine tips over: `edge` names over which, `time` when [s].

    A mission that it ended has left what happened until then in `run`, else that is None.
    """

    def __init__(self, message: str, edge: str, time: float) -> None:
        super().__init__(message)
        self.edge, self.time, self.run = edge, time, None


class Balance(NamedTuple):
    """What the steps keep of the balance: views of one memory.

    Attributes:
        before: coordinates and rates before the step, as in `forces.State`, shape (14,).
        touch: force [N] on the machine of what it touches but for ground and soil, and its moment
            about the world's origin [N m], in the world, shape (6,).
        point: zero-moment point in the vehicle's axes [m], NaN where nothing presses on the
            tracks, and what presses [N], shape (3,).
        margin: to the nearest edge [m], and the number of that edge, shape (2,).
        least: the least margin so far [m], the edge's number, the step, and the size of the soil's
            force then [N], shape (4,).
        tilt, rate: about the four edges [rad, rad/s], each of shape (4,).
    """

    before: NDArray
    touch: NDArray
    point: NDArray
    margin: NDArray
    least: NDArray
    tilt: NDArray
    rate: NDArray


MEMORY = 37
"""Length of the memory of a `Balance`."""


def balance_in(memory):
    """The `Balance` in a memory of length `MEMORY`."""
    return Balance(
        memory[:14],
        memory[14:20],
        memory[20:23],
        memory[23:25],
        memory[25:29],
        memory[29:33],
        memory[33:37],
    )


def masses_of(machine: Machine) -> NDArray:
    """What `stand` needs of a machine, shape (32,) [own units]; its bucket's mass comes last.

    Half length and width of the support polygon, inertia of all parts about themselves, length of
    the bucket, a `Body`, an `Arm`: arrays pass fastest into compiled code.
    """
    x, y = stability.support_polygon(machine).max(axis=0)
    parts = machine.swing, *machine.links
    inertia = machine.tracks.yaw_inertia + sum(part.inertia for part in parts)
    ahead = [x, y, inertia, machine.bucket.length]
    return np.array([*ahead, *body_of(machine), *arm_of(machine)], dtype=float)


def stand(masses, state, soil, balance, ticks, dt):
    """Balance the step that led from `balance.before` to the state, and follow the tilt.

    Args:
        masses: as from `masses_of`, the load added to its last number.
        state: coordinates and rates after the step, shape (14,).
        soil: as in `forces.State`, shape (4,).
        balance: memory of the `Balance`, changed in place.
        ticks: number of the step.
        dt: step [s].

    Returns:
        Number of the edge over which the machine has tipped, or -1.
    """
    balance = balance_in(balance)
    half_x, half_y, own, reach = masses[0], masses[1], masses[2], masses[3]
    body, arm = body_in(masses[4:11]), arm_in(masses[11:])
    q, dq = balance.before[:7], balance.before[7:]
    ax, ay, alpha = (state[7] - dq[0]) / dt, (state[8] - dq[1]) / dt, (state[9] - dq[2]) / dt
    ddp1, ddp2 = alpha + (state[10] - dq[3]) / dt, (state[11] - dq[4]) / dt
    ddp3 = ddp2 + (state[12] - dq[5]) / dt
    ddp4, dp3 = ddp3 + (state[13] - dq[6]) / dt, dq[4] + dq[5]
    p2 = q[4] + arm.o2
    p3 = p2 + (q[5] + arm.o3)
    p4 = p3 + (q[6] + arm.o4)
    v = vectors(arm, np.cos(p2), np.sin(p2), np.cos(p3), np.sin(p3), np.cos(p4), np.sin(p4))
    out_x, out_y = np.cos(q[3] + np.pi / 2), np.sin(q[3] + np.pi / 2)
    c, s = np.cos(q[2]), np.sin(q[2])
    move = Motion(
        dq[2] + dq[3],
        ddp1,
        dq[4],
        dp3,
        dp3 + dq[6],
        ddp2,
        ddp3,
        ddp4,
        dq[2],
        alpha,
        ax * c + ay * s,
        ay * c - ax * s,
    )
    pull = Pull(
        0.0,
        0.0,
        -arm.g,
        soil[0] * c + soil[1] * s,
        soil[1] * c - soil[0] * s,
        soil[2],
        soil[3],
        arm.b1 + v.l2r + v.l3r + reach * np.cos(p4),
        arm.z1 + v.l2z + v.l3z + reach * np.sin(p4),
    )
    ground = ground_reaction(body, arm, v, out_x, out_y, move, pull)
    touch = balance.touch
    moment_x, moment_y = touch[3] - q[1] * touch[2], touch[4] + q[0] * touch[2]
    fz = ground.fz - touch[2]
    mx = ground.mx - (moment_x * c + moment_y * s)
    my = ground.my - (moment_y * c - moment_x * s)

    # Moments that keep the tracks down, about the front, left, rear and right edge.
    holding = (half_x * fz + my, half_y * fz - mx, half_x * fz - my, half_y * fz + mx)
    margin, edge = np.inf, 0
    for k in range(4):
        if holding[k] < margin:
            margin, edge = holding[k], k
    margin = margin / fz if fz > 0.0 else -np.inf
    balance.point[0] = -my / fz if fz > 0.0 else np.nan
    balance.point[1] = mx / fz if fz > 0.0 else np.nan
    balance.point[2] = fz
    balance.margin[0], balance.margin[1] = margin, edge
    if margin < balance.least[0] - NOTICED:
        balance.least[0], balance.least[1], balance.least[2] = margin, edge, ticks
        balance.least[3] = np.sqrt(soil[0] ** 2 + soil[1] ** 2 + soil[2] ** 2)

    # Inertias about the edges: second moments of all masses, moved over.
    r2, z2, r3, z3, r4, z4 = joint_points(arm, v)
    places = (
        (body.m_u, 0.0, 0.0, body.z_u),
        (
            body.m_t,
            body.offset + body.ahead * out_x - body.aside * out_y,
            body.ahead * out_y + body.aside * out_x,
            body.z_t,
        ),
        (arm.m_bo, body.offset + r2 * out_x, r2 * out_y, z2),
        (arm.m_s, body.offset + r3 * out_x, r3 * out_y, z3),
        (arm.m_bu, body.offset + r4 * out_x, r4 * out_y, z4),
    )
    front = left = rear = right = own
    for m, x, y, z in places:
        front += m * ((x - half_x) ** 2 + z * z)
        left += m * ((y - half_y) ** 2 + z * z)
        rear += m * ((x + half_x) ** 2 + z * z)
        right += m * ((y + half_y) ** 2 + z * z)
    inertia = (front, left, rear, right)
    tipped = -1
    for k in range(4):
        balance.rate[k] -= dt * holding[k] / inertia[k]
        balance.tilt[k] += dt * balance.rate[k]
        if balance.tilt[k] <= 0.0:
            balance.tilt[k] = balance.rate[k] = 0.0
        elif balance.tilt[k] * 2 * (half_x if k % 2 == 0 else half_y) > LIFT:
            tipped = k
    for k in range(14):
        balance.before[k] = state[k]
    return tipped


def body_in(a):
    """The `Body` in an array."""
    return Body(a[0], a[1], a[2], a[3], a[4], a[5], a[6])


def arm_in(a):
    """The `Arm` in an array."""
    return Arm(
        a[0],
        a[1],
        a[2],
        a[3],
        a[4],
        a[5],
        a[6],
        a[7],
        a[8],
        a[9],
        a[10],
        a[11],
        a[12],
        a[13],
        a[14],
        a[15],
        a[16],
        a[17],
        a[18],
        a[19],
        a[20],
    )


def verdict(edge: int, time: float, q: NDArray, load: float, least: NDArray, machine: Machine):
    """The `Tipped` that says over which edge, when [s], by which load [kg] or force [N].

    Args:
        edge: its number in `stability.EDGES`.
        time: of the simulation [s].
        q: joint angles, shape (4,) [rad].
        load: in the bucket [kg].
        least: as in `Balance`, shape (4,).
        machine: that tips.
    """
    name = stability.EDGES[edge]
    try:
        limit, over = stability.tipping_load(q, machine=machine)
        rest = f"at rest it would take {limit:.0f} kg" if over else "at rest no load would tip it"
    except ValueError:
        rest = "it lies here even at rest and empty"
    beyond = f"carry it {-least[0]:.2f} m beyond the tracks" if np.isfinite(least[0]) else "pull"
    soil = f" while the soil held the bucket with {least[3] / 1e3:.0f} kN" if least[3] > 0 else ""
    return Tipped(
        f"the machine tips over its {name} edge at t = {time:.3f} s with {load:.0f} kg in the "
        f"bucket ({rest}): the ground had to {beyond}{soil}. Keep the load closer or smaller, or "
        "move more gently; call reset() before going on",
        name,
        time,
    )


def least_of(balance: Balance, dt: float) -> Least:
    """The least margin so far, for steps of dt [s]."""
    margin, edge, ticks, _ = balance.least.tolist()
    return Least(margin, ticks * dt, stability.EDGES[int(edge)])


def lesser(least: Least, margin: float, time: float, edge: str) -> Least:
    """The less of a least margin so far and a new margin [m] at a time [s]."""
    return Least(margin, time, edge) if margin < least.margin - NOTICED else least
