"""The thesis's filter as printed, and the program it descends from.

As printed, the pose that odometry has integrated is measured as if it were a fix from outside
(4.26), with an error that is new each time: the filter takes an average of a hundred of them and
believes itself right to centimetres, where all hundred share one error that grows. Its ancestor,
robot_pose_ekf of ROS, at least makes odometry and yaw relative to its own last estimate; it forgets
its covariance instead, by a process noise of 1000 m, so that its uncertainty stays what one
measurement has, however far it drives.

Both have the state x, y, z, roll, pitch, yaw. The ground is level here and roll and pitch are
measured as zero: they touch nothing else.

Source: Mastalli 2013, eqs. (4.24) to (4.27); odom_estimation.cpp of ros-planning/robot_pose_ekf.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.lessons.ekf.printed import H_IMU_427, H_ODOM_426, jacobian_425, motion_424
from backhoe.localisation import odometry
from backhoe.localisation.drives import Recording
from backhoe.localisation.fusion.checks import not_negative, start_pose
from backhoe.localisation.fusion.estimate import Estimate, Log
from backhoe.localisation.fusion.honest import START_STD, dead_reckoning
from backhoe.localisation.fusion.sampling import RATE, Increments, increments
from backhoe.localisation.kalman import BatchExtendedKalmanFilter
from backhoe.vehicle.tracks import tracks_twist

__all__ = ["MOTIONS", "PRINTED_Q", "as_ancestor", "as_printed"]

MOTIONS = ("still", "printed")

PRINTED_Q = (0.02**2, 0.02**2, 0.02**2, 0.02**2, 0.02**2, 0.02**2)
"""What a cycle adds [m^2, rad^2]: ours, none is printed. At 0.5 m/s the machine moves 0.017 m."""

_ANCESTOR_Q = 1000.0**2
_POSE = [0, 1, 5]


def as_printed(
    recording: Recording,
    *,
    motion: str = "still",
    Q: ArrayLike = PRINTED_Q,
    R_odometry: float = 0.02,
    R_imu: float = 0.02,
    start: ArrayLike | None = None,
    start_std: ArrayLike = START_STD,
    rate: float = RATE,
) -> Estimate:
    """The filter of the thesis: the integrated pose of the odometry as an absolute measurement.

    Source: Mastalli 2013, eqs. (4.24) to (4.27); Q, R and the start are not printed.

    Args:
        recording: one run or many.
        motion: "still", with no input as the text says (B = 0), so that the pose is expected to
            stay; or "printed", (4.24) with the speeds of the odometry and no T_s.
        Q: variances that a cycle adds, shape (6,) [m^2, rad^2].
        R_odometry, R_imu: variances of each pose and each angle [m^2, rad^2].
        start: pose at the start, shape (3,) or (runs, 3); default the truth.
        start_std: its standard deviations, shape (3,) [m, m, rad].
        rate: cycles a second [Hz].

    Returns:
        The estimate; state x, y, z, roll, pitch, yaw.

    Raises:
        ValueError: an unknown motion, or a number out of range.
    """
    if motion not in MOTIONS:
        raise ValueError(f"motion must be one of {', '.join(MOTIONS)}, got {motion!r}")
    steps = increments(recording, rate, use="latest")
    reckoned = np.atleast_3d(_runs(dead_reckoning(recording, start=start, rate=rate).pose))
    speed, omega = _speeds(recording, steps, motion)
    yaws = np.atleast_2d(steps.yaw)
    filter_ = BatchExtendedKalmanFilter(
        lambda x, u, dt: motion_424(x, u[:, 0], u[:, 1], dt),
        lambda x, u, dt: jacobian_425(x, u[:, 0], u[:, 1], dt),
        None,
        None,
        np.diag(np.asarray(Q, dtype=float)),
        None,
        *_start(start_pose(recording, start), start_std),
        angles=(3, 4, 5),
    )
    noise = _variances("R_odometry", R_odometry), _variances("R_imu", R_imu)
    log = Log(filter_.x, filter_.P, steps, _POSE)
    for k, dt in enumerate(steps.dt.tolist()):
        filter_.predict(np.stack([speed[:, k], omega[:, k]], axis=-1), dt)
        _measure(filter_, reckoned[:, k + 1], yaws[:, k], noise)
        log.add(filter_.x, filter_.P, None)
    return log.estimate("filter as printed", steps.time, recording.left.ndim == 1)


def as_ancestor(
    recording: Recording,
    *,
    R_odometry: float = 0.02,
    R_imu: float = 0.02,
    start: ArrayLike | None = None,
    start_std: ArrayLike = START_STD,
    rate: float = RATE,
) -> Estimate:
    """robot_pose_ekf: odometry and yaw made relative to the last estimate, the past forgotten.

    The change of the odometry's pose since the last cycle is put on the last estimate, and that is
    measured; likewise the change of the yaw. Their variances are multiplied by dt^2, and each
    prediction adds (1000 m)^2, so the covariance of the estimate before plays no part.

    Source: odom_estimation.cpp of ros-planning/robot_pose_ekf, which Mastalli 2013, eqs. (4.24) to
    (4.27), repeats without the relative measurements.

    Args:
        recording, R_odometry, R_imu, start, start_std, rate: as `as_printed`.

    Returns:
        The estimate; state x, y, z, roll, pitch, yaw.

    Raises:
        ValueError: a number out of range.
    """
    steps = increments(recording, rate, use="latest")
    reckoned = _runs(dead_reckoning(recording, start=start, rate=rate).pose)
    moved = odometry.relative(reckoned[:, :-1], reckoned[:, 1:])
    yaws = np.atleast_2d(steps.yaw)
    turned = np.diff(yaws, axis=1, prepend=np.nan)
    filter_ = BatchExtendedKalmanFilter(
        lambda x, u, dt: motion_424(x, np.zeros(len(x)), np.zeros(len(x)), dt),
        np.eye(6),
        None,
        None,
        _ANCESTOR_Q * np.eye(6),
        None,
        *_start(start_pose(recording, start), start_std),
        angles=(3, 4, 5),
    )
    odometer, imu = _variances("R_odometry", R_odometry), _variances("R_imu", R_imu)
    log = Log(filter_.x, filter_.P, steps, _POSE)
    for k, dt in enumerate(steps.dt.tolist()):
        last = filter_.x[:, _POSE]
        filter_.predict(None, dt)
        carried = odometry.compose(last, moved[:, k])
        yaw = None if k == 0 else last[:, 2] + turned[:, k]
        _measure(filter_, carried, yaw, (odometer * dt**2, imu * dt**2))
        log.add(filter_.x, filter_.P, None)
    return log.estimate("its ancestor", steps.time, recording.left.ndim == 1)


def _measure(
    filter_: BatchExtendedKalmanFilter,
    pose: NDArray,
    yaw: NDArray | None,
    noise: tuple[NDArray, NDArray],
) -> None:
    """Updates by (4.26) and, unless yaw is None, by (4.27)."""
    z = np.zeros((len(pose), 6))
    z[:, _POSE] = pose
    filter_.update(z, H=H_ODOM_426, R=noise[0])
    if yaw is not None:
        z = np.zeros((len(pose), 6))
        z[:, 5] = yaw
        filter_.update(z, H=H_IMU_427, R=noise[1])


def _speeds(recording: Recording, steps: Increments, motion: str) -> tuple[NDArray, NDArray]:
    left, right = np.atleast_2d(steps.left), np.atleast_2d(steps.right)
    if motion == "still":
        return np.zeros_like(left), np.zeros_like(left)
    way, turn = tracks_twist(left, right, recording.machine)
    return way / steps.dt, turn / steps.dt


def _start(pose: NDArray, std: ArrayLike) -> tuple[NDArray, NDArray]:
    x0, P0 = np.zeros((len(pose), 6)), np.zeros((6, 6))
    x0[:, _POSE] = pose
    P0[_POSE, _POSE] = np.asarray(std, dtype=float) ** 2
    return x0, P0


def _variances(name: str, value: float) -> NDArray:
    if not_negative(name, value) == 0:
        raise ValueError(f"{name} must be a positive variance, got 0")
    return float(value) * np.eye(6)


def _runs(poses: NDArray) -> NDArray:
    return poses[None] if poses.ndim == 2 else poses
