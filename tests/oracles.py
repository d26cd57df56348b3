"""The same arm in other people's dynamics libraries, built from the machine's numbers alone."""

from __future__ import annotations

from functools import cache
from math import cos, pi, sin

import numpy as np

from backhoe.machine import BACKHOE, Machine


def pinocchio_model(machine: Machine = BACKHOE):
    """The arm as a Pinocchio model, joint by joint from the Denavit-Hartenberg rows."""
    import pinocchio as pin

    def translation(x: float, z: float = 0.0) -> pin.SE3:
        return pin.SE3(np.eye(3), np.array([x, 0.0, z]))

    def rotation(axis: str, angle: float) -> pin.SE3:
        return pin.SE3(pin.utils.rotate(axis, angle), np.zeros(3))

    def inertia(mass: float, x: float, y: float, z: float, moment: float) -> pin.Inertia:
        return pin.Inertia(mass, np.array([x, y, z]), moment * np.eye(3))

    base, swing = machine.base, machine.swing
    model = pin.Model()
    model.gravity.linear = np.array([0.0, 0.0, -machine.gravity])

    placement = translation(base.offset, base.height) * rotation("z", pi / 2)
    joint = model.addJoint(0, pin.JointModelRZ(), placement, "swing")
    swing_com = (
        swing.com_radius * cos(swing.com_angle),
        swing.com_radius * sin(swing.com_angle),
        swing.com_height,
    )
    model.appendBodyToJoint(
        joint, inertia(swing.mass, *swing_com, swing.inertia), pin.SE3.Identity()
    )

    placement = translation(swing.offset, swing.height) * rotation("x", pi / 2)
    for name, link in zip(("boom", "stick", "bucket"), machine.links, strict=True):
        placement = placement * rotation("z", link.angle_offset)
        joint = model.addJoint(joint, pin.JointModelRZ(), placement, name)
        bend = link.com_angle - link.angle_offset
        com = (link.com_radius * cos(bend), link.com_radius * sin(bend), 0.0)
        model.appendBodyToJoint(joint, inertia(link.mass, *com, link.inertia), pin.SE3.Identity())
        placement = translation(link.length)
        tip = {"boom": "boom", "stick": "stick", "bucket": "tip"}[name]
        model.addFrame(pin.Frame(tip, joint, 0, placement, pin.FrameType.OP_FRAME))
    return model


def urdf(machine: Machine = BACKHOE) -> str:
    """The arm as a URDF on a fixed base; every link's x axis runs through its centre of mass.

    PyBullet's inverse dynamics refuses a large inertia whose products are not exactly zero.
    """
    base, swing = machine.base, machine.swing

    def link(name: str, mass: float, com: tuple[float, float, float], inertia: float) -> str:
        xyz = " ".join(map(repr, com))
        return (
            f'<link name="{name}"><inertial><origin xyz="{xyz}"/><mass value="{mass!r}"/><inertia'
            f' ixx="{inertia!r}" iyy="{inertia!r}" izz="{inertia!r}" ixy="0" ixz="0" iyz="0"/>'
            "</inertial></link>"
        )

    def joint(parent: str, child: str, axis: str, xyz: tuple, rpy: tuple) -> str:
        return (
            f'<joint name="{child}" type="continuous"><parent link="{parent}"/><child'
            f' link="{child}"/><axis xyz="{axis}"/><origin xyz="{" ".join(map(repr, xyz))}"'
            f' rpy="{" ".join(map(repr, rpy))}"/><dynamics damping="0" friction="0"/></joint>'
        )

    parts = [
        '<link name="base"/>',
        joint("base", "swing", "0 0 1", (base.offset, 0.0, base.height), (0.0, 0.0, pi / 2)),
        link(
            "swing",
            swing.mass,
            (swing.com_radius * round(cos(swing.com_angle), 12), 0.0, swing.com_height),
            swing.inertia,
        ),
    ]
    parent, xyz, bend = "swing", (swing.offset, 0.0, swing.height), 0.0
    for name, body in zip(("boom", "stick", "bucket"), machine.links, strict=True):
        child_bend = body.com_angle - body.angle_offset
        turn = body.angle_offset + child_bend - bend
        parts.append(joint(parent, name, "0 -1 0", xyz, (0.0, -turn, 0.0)))
        parts.append(link(name, body.mass, (body.com_radius, 0.0, 0.0), body.inertia))
        parent, bend = name, child_bend
        xyz = (body.length * cos(bend), 0.0, -body.length * sin(bend))
    return f'<robot name="backhoe">{"".join(parts)}</robot>'


def mjcf(machine: Machine = BACKHOE, actuators: str | None = None) -> str:
    """The arm as a MuJoCo model on a fixed base, with viscous friction and nothing to collide.

    Args:
        actuators: elements of the model's actuators; one motor for each joint unless told.
    """
    base, swing = machine.base, machine.swing

    def body(name: str, xyz: tuple, rpy: tuple, axis: str, viscous: float) -> str:
        return (
            f'<body name="{name}" pos="{" ".join(map(repr, xyz))}"'
            f' euler="{" ".join(map(repr, rpy))}">'
            f'<joint name="{name}" axis="{axis}" damping="{float(viscous)!r}"/>'
        )

    def inertial(mass: float, com: tuple[float, float, float], moment: float) -> str:
        return (
            f'<inertial pos="{" ".join(map(repr, com))}" mass="{mass!r}"'
            f' diaginertia="{moment!r} {moment!r} {moment!r}"/>'
        )

    r, a = swing.com_radius, swing.com_angle
    parts = [
        body("swing", (base.offset, 0.0, base.height), (0, 0, pi / 2), "0 0 1", machine.viscous[0]),
        inertial(swing.mass, (r * cos(a), r * sin(a), swing.com_height), swing.inertia),
    ]
    xyz = (swing.offset, 0.0, swing.height)
    names = ("boom", "stick", "bucket")
    for name, link, viscous in zip(names, machine.links, machine.viscous[1:], strict=True):
        bend = link.com_angle - link.angle_offset
        com = (link.com_radius * cos(bend), 0.0, link.com_radius * sin(bend))
        parts.append(body(name, xyz, (0, -link.angle_offset, 0), "0 -1 0", viscous))
        parts.append(inertial(link.mass, com, link.inertia))
        xyz = (link.length, 0.0, 0.0)
    motors = "".join(f'<motor joint="{name}"/>' for name in ("swing", *names))
    return (
        '<mujoco><compiler angle="radian"/>'
        f'<option timestep="0.001" gravity="0 0 {-machine.gravity!r}">'
        '<flag contact="disable" constraint="disable"/></option>'
        f"<worldbody>{''.join(parts)}{'</body>' * 4}</worldbody>"
        f"<actuator>{actuators or motors}</actuator></mujoco>"
    )


def _machine_numbers(machine: Machine) -> tuple[list[float], list[list[float]]]:
    base, swing = machine.base, machine.swing
    house = [
        machine.gravity,
        base.offset,
        base.height,
        swing.offset,
        swing.height,
        swing.mass,
        swing.com_radius,
        swing.com_angle,
        swing.com_height,
        swing.inertia,
    ]
    links = [
        [
            link.length,
            link.angle_offset,
            link.mass,
            link.com_radius,
            link.com_angle,
            link.inertia,
        ]
        for link in machine.links
    ]
    return house, links


@cache
def _lagrangian_terms():
    """M, C dq, g and the energies derived by SymPy, as functions of q, dq and the numbers."""
    import sympy as sp

    q, dq = sp.symbols("q1:5"), sp.symbols("dq1:5")
    house = g, b0, L0, b1, L1, m_t, r_t, a_t, z_t, I_t = sp.symbols(
        "g b0 L0 b1 L1 m_t r_t a_t z_t I_t"
    )
    links = [sp.symbols(f"L{i} o{i} m{i} r{i} a{i} I{i}") for i in (2, 3, 4)]

    yaw = q[0] + sp.pi / 2
    outwards = sp.Matrix([sp.cos(yaw), sp.sin(yaw), 0])
    axis = sp.Matrix([sp.sin(yaw), -sp.cos(yaw), 0])
    up = sp.Matrix([0, 0, 1])
    ring = sp.Matrix([b0, 0, L0])
    behind = r_t * sp.Matrix([sp.cos(yaw + a_t), sp.sin(yaw + a_t), 0])
    bodies = [(m_t, ring + behind + z_t * up, I_t, dq[0] * up)]
    point, pitch, rate = ring + b1 * outwards + L1 * up, 0, 0
    for (L, o, m, r, a, inertia), angle, speed in zip(links, q[1:], dq[1:], strict=True):
        rate = rate + speed
        aim = pitch + angle + a
        com = point + r * (sp.cos(aim) * outwards + sp.sin(aim) * up)
        bodies.append((m, com, inertia, dq[0] * up + rate * axis))
        pitch = pitch + angle + o
        point = point + L * (sp.cos(pitch) * outwards + sp.sin(pitch) * up)

    kinetic = potential = 0
    for mass, com, inertia, spin in bodies:
        velocity = com.jacobian(q) * sp.Matrix(dq)
        kinetic += (mass * velocity.dot(velocity) + inertia * spin.dot(spin)) / 2
        potential += mass * g * com[2]
    momentum = sp.Matrix([kinetic]).jacobian(dq)
    centrifugal = momentum.jacobian(q) * sp.Matrix(dq) - sp.Matrix([kinetic]).jacobian(q).T
    terms = (momentum.jacobian(dq), centrifugal, sp.Matrix([potential]).jacobian(q), kinetic)
    numbers = (q, dq, house, links)
    return sp.lambdify(numbers, (*terms, potential), cse=True)


class Lagrangian:
    """The arm's equation of motion from positions of the centres of mass and spins alone."""

    def __init__(self, machine: Machine = BACKHOE) -> None:
        self._numbers = _machine_numbers(machine)

    def terms(self, q: np.ndarray, dq: np.ndarray) -> tuple:
        """M (4, 4), C dq (4,), g (4,), kinetic and potential energy."""
        M, h, g, kinetic, potential = _lagrangian_terms()(q, dq, *self._numbers)
        return M, h.ravel(), g.ravel(), kinetic, potential
