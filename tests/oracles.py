"""The same arm in other people's dynamics libraries, built from the machine's numbers alone."""

from __future__ import annotations

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


class Lagrangian:
    """M, C and g derived by SymPy from the energies alone, as functions of numbers.

    Built from positions of the centres of mass in space and angular velocities; nothing is shared
    with the library but the machine's numbers.
    """

    def __init__(self, machine: Machine = BACKHOE) -> None:
        import sympy as sp

        q = sp.symbols("q1:5")
        dq = sp.symbols("dq1:5")
        base, swing = machine.base, machine.swing
        yaw = q[0] + sp.pi / 2
        outwards = sp.Matrix([sp.cos(yaw), sp.sin(yaw), 0])
        up = sp.Matrix([0, 0, 1])
        house = sp.Matrix([base.offset, 0, base.height])
        behind = yaw + swing.com_angle
        com = house + swing.com_radius * sp.Matrix([sp.cos(behind), sp.sin(behind), 0])
        bodies = [(swing.mass, com + swing.com_height * up, swing.inertia, dq[0] * up)]
        point = house + swing.offset * outwards + swing.height * up
        pitch, axis, rate = 0, sp.Matrix([sp.sin(yaw), -sp.cos(yaw), 0]), 0
        for body, angle, speed in zip(machine.links, q[1:], dq[1:], strict=True):
            rate = rate + speed
            aim = pitch + angle + body.com_angle
            com = point + body.com_radius * (sp.cos(aim) * outwards + sp.sin(aim) * up)
            bodies.append((body.mass, com, body.inertia, dq[0] * up + rate * axis))
            pitch = pitch + angle + body.angle_offset
            point = point + body.length * (sp.cos(pitch) * outwards + sp.sin(pitch) * up)

        kinetic = potential = 0
        for mass, com, inertia, spin in bodies:
            velocity = com.jacobian(q) * sp.Matrix(dq)
            kinetic += (mass * velocity.dot(velocity) + inertia * spin.dot(spin)) / 2
            potential += mass * machine.gravity * com[2]
        M = sp.hessian(kinetic, dq)
        momentum = sp.Matrix([kinetic]).jacobian(dq).T
        centrifugal = momentum.jacobian(q) * sp.Matrix(dq) - sp.Matrix([kinetic]).jacobian(q).T
        g = sp.Matrix([potential]).jacobian(q).T
        arguments = (*q, *dq)
        self._M, self._h, self._g, self._energy = (
            sp.lambdify(arguments, expression, cse=True)
            for expression in (M, centrifugal, g, (kinetic, potential))
        )

    def mass_matrix(self, q: np.ndarray) -> np.ndarray:
        return np.array(self._M(*q, *np.zeros(4)), dtype=float)

    def centrifugal_torque(self, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
        return np.array(self._h(*q, *dq), dtype=float).ravel()

    def gravity_torque(self, q: np.ndarray) -> np.ndarray:
        return np.array(self._g(*q, *np.zeros(4)), dtype=float).ravel()

    def energy(self, q: np.ndarray, dq: np.ndarray) -> tuple[float, float]:
        return self._energy(*q, *dq)
