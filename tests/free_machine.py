"""The machine in PyBullet with nothing under it but its tracks on a plane: it can really tip."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np

from backhoe.arm import kinematics
from backhoe.machine import BACKHOE, JOINTS
from backhoe.simulation import bullet
from backhoe.simulation.urdf import urdf
from backhoe.whole_body import stability

DT = 0.001


def free_urdf(machine=BACKHOE):
    """The machine's URDF with the undercarriage as its root, on two boxes for tracks."""
    robot = ET.fromstring(urdf(machine))
    for name in ("world", "base_x", "base_y"):
        robot.remove(robot.find(f"link[@name='{name}']"))
    for name in ("base_x", "base_y", "base_yaw"):
        robot.remove(robot.find(f"joint[@name='{name}']"))
    tracks, root = machine.tracks, robot.find("link[@name='base_yaw']")
    for old in root.findall("inertial"):
        root.remove(old)
    inertial = ET.SubElement(root, "inertial")
    ET.SubElement(inertial, "origin", xyz=f"0 0 {tracks.height / 2!r}")
    ET.SubElement(inertial, "mass", value=repr(tracks.mass))
    moment = repr(tracks.yaw_inertia)
    ET.SubElement(
        inertial, "inertia", ixx=moment, iyy=moment, izz=moment, ixy="0", ixz="0", iyz="0"
    )
    for side in (1, -1):
        collision = ET.SubElement(root, "collision")
        at = f"0 {side * tracks.gauge / 2!r} {tracks.height / 2!r}"
        ET.SubElement(collision, "origin", xyz=at)
        box = ET.SubElement(collision, "geometry")
        size = f"{tracks.length!r} {tracks.shoe_width!r} {tracks.height!r}"
        ET.SubElement(box, "box", size=size)
    return ET.tostring(robot, encoding="unicode")


class FreeMachine:
    """The machine on a plane, its joints held or turned by motors; use it in a `with` statement."""

    def __init__(self, q, load=0.0, gravity=None, machine=BACKHOE):
        self.machine = machine
        self.server = server = bullet.Server()
        server.setTimeStep(DT)
        server.setGravity(*(gravity if gravity is not None else (0, 0, -machine.gravity)))
        plane = server.createCollisionShape(server.GEOM_PLANE)
        self.plane = server.createMultiBody(0, plane)
        server.changeDynamics(self.plane, -1, lateralFriction=1.0)
        self.body = server.load_urdf(free_urdf(machine))
        server.free(self.body)
        server.changeDynamics(self.body, -1, lateralFriction=1.0)
        self.joint = server.joints(self.body)
        bucket = self.joint["bucket"]
        server.changeDynamics(
            self.body,
            bucket,
            mass=machine.bucket.mass + load,
            localInertiaDiagonal=[machine.bucket.inertia] * 3,
        )
        self.indices = [self.joint[name] for name in JOINTS]
        for index, angle in zip(self.indices, q, strict=True):
            server.resetJointState(self.body, index, angle)
        self.turn(np.zeros(4))

    def turn(self, speeds, most=1e8):
        """Turn the joints at speeds (4,) [rad/s] with torques of at most `most` [N m]."""
        server = self.server
        server.setJointMotorControlArray(
            self.body,
            self.indices,
            server.VELOCITY_CONTROL,
            targetVelocities=list(speeds),
            forces=list(np.broadcast_to(most, 4)),
        )

    def state(self):
        """Joint angles and rates, each of shape (4,)."""
        angles, rates, *_ = zip(*self.server.getJointStates(self.body, self.indices), strict=True)
        return np.array(angles), np.array(rates)

    @property
    def tilt(self):
        """How far the vehicle's z axis leans [rad]."""
        _, turned = self.server.getBasePositionAndOrientation(self.body)
        matrix = self.server.getMatrixFromQuaternion(turned)
        return float(np.arccos(min(matrix[8], 1.0)))

    def base_rates(self):
        """Velocity of the vehicle's origin [m/s] and its turning [rad/s], each of shape (3,)."""
        v, w = map(np.array, self.server.getBaseVelocity(self.body))
        at, _ = self.server.getBasePositionAndOrientation(self.body)
        return v - np.cross(w, [0.0, 0.0, at[2]]), w

    def coordinates(self):
        """x, y, yaw, joint angles and their rates, as the simulations count them, shape (14,)."""
        (angles, rates), (v, w) = self.state(), self.base_rates()
        at, turned = self.server.getBasePositionAndOrientation(self.body)
        yaw = self.server.getEulerFromQuaternion(turned)[2]
        return np.r_[at[:2], yaw, angles, v[:2], w[2], rates]

    def catch(self, most):
        """Tie the bucket's teeth to the ground where they are, with at most a force [N]."""
        server, bucket = self.server, self.joint["bucket"]
        q, _ = self.state()
        tip = kinematics.forward_kinematics(q, machine=self.machine)[:3, 3]
        link = server.getLinkState(self.body, bucket)
        # Points of a constraint are counted from the centre of mass.
        com = server.invertTransform(link[0], link[1])
        own, _ = server.multiplyTransforms(*com, tip.tolist(), [0, 0, 0, 1])
        rock = server.createConstraint(
            self.body, bucket, -1, -1, server.JOINT_POINT2POINT, [0, 0, 0], own, tip.tolist()
        )
        server.changeConstraint(rock, maxForce=most)
        return rock

    def pull_of(self, rock):
        """What the rock gives the teeth along the vehicle's axes, as `stability` wants it, (4,)."""
        force = -np.array(self.server.getConstraintState(rock)[:3])
        return np.append(force, 0.0)

    def step(self, count=1):
        for _ in range(count):
            self.server.stepSimulation()

    def carried_at(self):
        """Centre of the ground's pressure on the tracks, x, y [m], and its force upwards [N]."""
        points = self.server.getContactPoints(bodyA=self.body, bodyB=self.plane)
        at = np.array([point[5][:2] for point in points])
        force = np.array([point[9] for point in points])
        return force @ at / force.sum(), force.sum()

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.server.disconnect()


def random_postures(rng, count, machine=BACKHOE):
    """Joint angles in which the bucket is over the ground and a load tips the machine, (n, 4)."""
    found = []
    while len(found) < count:
        q = rng.uniform(machine.lower, machine.upper)
        if stability.centre_of_mass(q, machine=machine)[2] < 0.5:
            continue
        try:
            load, edge = stability.tipping_load(q, machine=machine)
        except ValueError:
            continue
        if edge and load < 20e3:
            found.append(q)
    return np.array(found)
