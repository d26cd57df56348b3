"""What presses on the ground: the equations, each written once, for numbers and for arrays alike.

All that has mass pulls down and resists being accelerated; the ground gives the force and moment
that are left over. Axes are the vehicle's own, x forward, y left, z up from the ground; the arm's
plane has r outwards from the swing axis. Arithmetic and nothing else, as in `arm.dynamics.terms`.
"""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

from backhoe.arm.dynamics.terms import Arm, Vectors
from backhoe.machine import Machine


class Body(NamedTuple):
    """Where the machine's mass is, in floats: SI units.

    The turret's centre of mass lies `ahead` of and `aside` (left of) the swing axis in the house's
    own frame and at height `z_t`; the swing axis `offset` before the vehicle's origin; the
    undercarriage at height `z_u` above that.
    """

    m_t: float
    ahead: float
    aside: float
    z_t: float
    offset: float
    m_u: float
    z_u: float


class Motion(NamedTuple):
    """How the machine moves: rates and accelerations of joints and vehicle.

    `w` and `dw` are the house's yaw rate and its change over the ground, swing and vehicle together
    [rad/s, rad/s^2]; `dp2` to `ddp4` those of the pitch of boom, stick and bucket; `omega`, `alpha`
    of the vehicle's yaw; `ax`, `ay` the acceleration of its origin along its own axes [m/s^2].
    """

    w: float
    dw: float
    dp2: float
    dp3: float
    dp4: float
    ddp2: float
    ddp3: float
    ddp4: float
    omega: float
    alpha: float
    ax: float
    ay: float


class Pull(NamedTuple):
    """What pulls: gravity along the vehicle's axes [m/s^2] and the soil at the bucket's tip.

    The soil's force is along the vehicle's axes [N], its `moment` raises the bucket's pitch [N m];
    the tip is `tip_r` outwards from the swing axis and `tip_z` above the ground [m].
    """

    gx: float
    gy: float
    gz: float
    fx: float
    fy: float
    fz: float
    moment: float
    tip_r: float
    tip_z: float


class Reaction(NamedTuple):
    """The ground on the tracks: force [N], and moment about the vehicle's x and y axes [N m]."""

    fx: float
    fy: float
    fz: float
    mx: float
    my: float


def body_of(machine: Machine) -> Body:
    """What the balance needs of a machine, beside its arm."""
    base, swing, tracks = machine.base, machine.swing, machine.tracks
    numbers = (
        swing.mass,
        swing.com_radius * cos(swing.com_angle),
        swing.com_radius * sin(swing.com_angle),
        base.height + swing.com_height,
        base.offset,
        tracks.mass,
        tracks.com_height,
    )
    return Body(*map(float, numbers))


def joint_points(arm: Arm, v: Vectors):
    """Centres of mass of boom, stick and bucket, each r and z [m]."""
    r3, z3 = arm.b1 + v.l2r, arm.z1 + v.l2z
    r4, z4 = r3 + v.l3r, z3 + v.l3z
    return (
        arm.b1 + v.c2r,
        arm.z1 + v.c2z,
        r3 + v.c3r,
        z3 + v.c3z,
        r4 + v.c4r,
        z4 + v.c4z,
    )


def ground_reaction(body: Body, arm: Arm, v: Vectors, out_x, out_y, move: Motion, pull: Pull):
    """Force and moment with which the ground keeps the tracks flat: Newton and Euler, all masses.

    Each mass m at p with acceleration a needs the force m (a - g); a link that turns needs the
    moment I times its angular acceleration. What the soil does not give, the ground must.

    Args:
        body, arm: of the machine, with its load in the bucket.
        v: `arm.dynamics.terms.vectors` of the posture.
        out_x, out_y: unit vector outwards along the arm, in the vehicle's axes [1].
        move: the motion.
        pull: gravity and soil.

    Returns:
        The `Reaction`.
    """
    r2, z2, r3, z3, r4, z4 = joint_points(arm, v)
    # Of the joints in the arm's plane: speed outwards, accelerations outwards and up.
    dr3, ddr3 = -move.dp2 * v.l2z, -move.ddp2 * v.l2z - move.dp2 * move.dp2 * v.l2r
    ddz3 = move.ddp2 * v.l2r - move.dp2 * move.dp2 * v.l2z
    dr4 = dr3 - move.dp3 * v.l3z
    ddr4 = ddr3 - move.ddp3 * v.l3z - move.dp3 * move.dp3 * v.l3r
    ddz4 = ddz3 + move.ddp3 * v.l3r - move.dp3 * move.dp3 * v.l3z
    # Of the swing axis, over the ground.
    axis_x = move.ax - move.omega * move.omega * body.offset
    axis_y = move.ay + move.alpha * body.offset

    fx, fy = body.m_u * (move.ax - pull.gx), body.m_u * (move.ay - pull.gy)
    fz = -body.m_u * pull.gz
    mx, my = -body.z_u * fy, body.z_u * fx
    w, dw = move.w, move.dw
    masses = (
        (body.m_t, body.ahead, body.aside, body.z_t, 0.0, 0.0, 0.0),
        (
            arm.m_bo,
            r2,
            0.0,
            z2,
            -move.dp2 * v.c2z,
            -move.ddp2 * v.c2z - move.dp2 * move.dp2 * v.c2r,
            move.ddp2 * v.c2r - move.dp2 * move.dp2 * v.c2z,
        ),
        (
            arm.m_s,
            r3,
            0.0,
            z3,
            dr3 - move.dp3 * v.c3z,
            ddr3 - move.ddp3 * v.c3z - move.dp3 * move.dp3 * v.c3r,
            ddz3 + move.ddp3 * v.c3r - move.dp3 * move.dp3 * v.c3z,
        ),
        (
            arm.m_bu,
            r4,
            0.0,
            z4,
            dr4 - move.dp4 * v.c4z,
            ddr4 - move.ddp4 * v.c4z - move.dp4 * move.dp4 * v.c4r,
            ddz4 + move.ddp4 * v.c4r - move.dp4 * move.dp4 * v.c4z,
        ),
    )
    for m, r, s, z, dr, ddr, ddz in masses:
        radial = ddr - w * w * r - dw * s
        turned = dw * r - w * w * s + 2 * w * dr
        px = m * (axis_x + radial * out_x - turned * out_y - pull.gx)
        py = m * (axis_y + radial * out_y + turned * out_x - pull.gy)
        pz = m * (ddz - pull.gz)
        x = body.offset + r * out_x - s * out_y
        y = r * out_y + s * out_x
        fx, fy, fz = fx + px, fy + py, fz + pz
        mx, my = mx + y * pz - z * py, my + z * px - x * pz

    # Links turn about the plane's normal (out_y, -out_x), which turns with the house.
    spin = arm.I_bo * move.ddp2 + arm.I_s * move.ddp3 + arm.I_bu * move.ddp4 - pull.moment
    swept = w * (arm.I_bo * move.dp2 + arm.I_s * move.dp3 + arm.I_bu * move.dp4)
    x, y = body.offset + pull.tip_r * out_x, pull.tip_r * out_y
    mx += spin * out_y + swept * out_x - y * pull.fz + pull.tip_z * pull.fy
    my += -spin * out_x + swept * out_y - pull.tip_z * pull.fx + x * pull.fz
    return Reaction(fx - pull.fx, fy - pull.fy, fz - pull.fz, mx, my)


def zero_moment(force: Reaction):
    """Where a force of the ground that presses (fz > 0) acts: x, y in the vehicle's axes [m]."""
    return -force.my / force.fz, force.mx / force.fz
