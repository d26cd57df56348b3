"""Points from ranges while the machine moves: each beam with the pose that it was sent from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics import link_transforms
from backhoe.basics.inputs import alike, instance, numbers, real_numbers, times
from backhoe.machine import BACKHOE, JOINTS, Machine
from backhoe.machine.sensors import Laser, Mount, sensor_pose
from backhoe.perception.laser.lines import directions


@dataclass(frozen=True)
class Motion:
    """Joint angles and the vehicle's pose over time, as measured or as they were.

    Between two times they change evenly; before the first and after the last they stand still.

    Attributes:
        time: rising, shape (n,) [s].
        q: joint angles swing, boom, stick, bucket, shape (n, 4) [rad].
        pose: x, y, yaw of the vehicle, shape (n, 3) [m, m, rad]; yaw without jumps by full turns.

    Raises:
        ValueError: other shapes, values that are not finite, times that do not rise.
    """

    time: NDArray
    q: NDArray
    pose: NDArray

    def __post_init__(self) -> None:
        time = times(self.time, "time", least=1)
        q = numbers(self.q, "q", (len(time), 4), meaning="joints (swing, boom, stick, bucket)")
        pose = numbers(self.pose, "pose", (len(time), 3), meaning="x, y, yaw")
        for name, value in (("time", time), ("q", q), ("pose", pose)):
            object.__setattr__(self, name, value)

    @classmethod
    def standing(cls, q: ArrayLike, pose: ArrayLike = (0.0, 0.0, 0.0)) -> Motion:
        """No motion: joint angles, shape (4,) [rad], and x, y, yaw, shape (3,) [m, m, rad]."""
        return cls([0.0], [numbers(q, "q", (4,))], [numbers(pose, "pose", (3,))])

    @property
    def still(self) -> bool:
        """Whether nothing moves."""
        return bool((self.q == self.q[0]).all() and (self.pose == self.pose[0]).all())

    def at(self, time: ArrayLike) -> tuple[NDArray, NDArray]:
        """Joint angles and pose at times of any shape [s], of shapes (..., 4) [rad] and (..., 3)
        [m, m, rad]."""
        t = numbers(time, "time")
        columns = [np.interp(t, self.time, x) for x in np.c_[self.q, self.pose].T]
        return np.stack(columns[:4], axis=-1), np.stack(columns[4:], axis=-1)

    def link_poses(self, time: ArrayLike, machine: Machine = BACKHOE) -> dict[str, NDArray]:
        """Poses in the world of undercarriage, swing, boom, stick and bucket at times of any shape
        [s], each of shape (..., 4, 4) [1, m]."""
        instance(machine, "machine", Machine)
        q, pose = self.at(time)
        x, y, yaw = np.moveaxis(pose, -1, 0)
        T = np.zeros((*x.shape, 4, 4))
        T[..., 0, 0] = T[..., 1, 1] = np.cos(yaw)
        T[..., 1, 0], T[..., 0, 1] = np.sin(yaw), -np.sin(yaw)
        T[..., 0, 3], T[..., 1, 3] = x, y
        T[..., 2, 2] = T[..., 3, 3] = 1.0
        links = np.moveaxis(T[..., None, :, :] @ link_transforms(q, machine), -3, 0)
        return dict(zip(JOINTS, links, strict=True), undercarriage=T)


def sensor_poses(
    mount: Mount, time: ArrayLike, motion: Motion, machine: Machine = BACKHOE
) -> NDArray:
    """Poses of a sensor in the world.

    Args:
        mount: where it sits.
        time: any shape [s].
        motion: of the machine.
        machine: whose arm it is.

    Returns:
        Shape (..., 4, 4) [1, m]; `[..., :3, 3]` is where the beams of a laser start.

    Raises:
        ValueError: a time that is not finite.
        TypeError: another kind of mount or motion.
    """
    mount = instance(mount, "mount", Mount)
    poses = instance(motion, "motion", Motion).link_poses(time, machine)
    return sensor_pose(poses[mount.link], mount)


def deskew(
    laser: Laser,
    time: ArrayLike,
    ranges: ArrayLike,
    motion: Motion,
    machine: Machine = BACKHOE,
) -> NDArray:
    """Points in the world, each beam from where the sensor was when it was sent.

    A clock that runs late by dt, or a pose that is old by dt, moves a point at distance r from an
    axis about which the machine turns at omega by omega r dt.

    Args:
        laser: the scanner.
        time: of each beam, shape (lines, beams) [s].
        ranges: shape (lines, beams) [m]; NaN where nothing came back.
        motion: of the machine, as it is known.
        machine: whose arm it is.

    Returns:
        Shape (lines, beams, 3) [m], NaN where nothing came back.

    Raises:
        ValueError: other shapes, times that are not finite.
        TypeError: another kind of laser or motion.
    """
    ranges, beams = real_numbers(ranges, "ranges"), directions(laser, time)
    alike(ranges=ranges, time=beams[..., 0])
    T = sensor_poses(laser.mount, time, motion, machine)
    reach = ranges[..., None] * beams
    return (T[..., :3, :3] @ reach[..., None])[..., 0] + T[..., :3, 3]
