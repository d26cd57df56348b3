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
