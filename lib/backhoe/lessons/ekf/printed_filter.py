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

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, numbers, positive
from backhoe.lessons.ekf.printed import H_IMU_427, H_ODOM_426, jacobian_425, motion_424
from backhoe.localisation import odometry
from backhoe.localisation.drives import Recording
from backhoe.localisation.fusion import (
    CYCLE_RATE,
    START_STD,
    Estimate,
    Increments,
    dead_reckoning,
    increments,
)
from backhoe.localisation.fusion.estimate import Log
from backhoe.localisation.kalman import BatchExtendedKalmanFilter
from backhoe.vehicle.tracks import tracks_twist

__all__ = ["PRINTED_Q", "as_ancestor", "as_printed"]

MOTIONS = ("still", "printed")

PRINTED_Q = (0.02**2, 0.02**2, 0.02**2, 0.02**2, 0.02**2, 0.02**2)
"""What a cycle adds [m^2, rad^2]: ours, none is printed. At 0.5 m/s the machine moves 0.017 m."""

_ANCESTOR_Q = 6 * (1000.0**2,)
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
    rate: float = CYCLE_RATE,
) -> Estimate:
    """The filter of the thesis: the integrated pose of the odometry as an absolute measurement.

    Source: Mastalli 2013, eqs. (4.24) to (4.27); Q, R and the start are not printed.

    Args:
        recording: one run or many.
        motion: "still", with no input as the text says (B = 0), so that the pose is expected to
            stay; or "printed", (4.24) with the speeds of the odometry and no T_s.
        Q: variances that a cycle adds, shape (6,) [m^2, rad^2].
        R_odometry, R_imu: variances of each pose and each angle [m^2, rad^2].
        start: pose at the start, shape (3,) or (runs, 3) [m, m, rad]; default the truth.
        start_std: its standard deviations, shape (3,) [m, m, rad].
        rate: cycles a second [Hz].

    Returns:
        The estimate; state x, y, z, roll, pitch, yaw.

    Raises:
        ValueError: an unknown motion, or a number out of range.
    """
    choice(motion, "motion", MOTIONS)
    R = positive(R_odometry, "R_odometry"), positive(R_imu, "R_imu")
    reckoned, yaws, steps = _odometry(recording, start, rate)
    u = np.zeros((*yaws.shape, 2))
    if motion == "printed":
        sides = np.atleast_2d(steps.left), np.atleast_2d(steps.right)
        u = np.stack(tracks_twist(*sides, recording.machine), axis=-1) / steps.dt[:, None]

    def measured(k: int, dt: float, last: NDArray) -> tuple:
        return reckoned[:, k + 1], yaws[:, k], R

    return _filtered("filter as printed", reckoned[:, 0], start_std, steps, u, Q, measured)


def as_ancestor(
    recording: Recording,
    *,
    R_odometry: float = 0.02,
    R_imu: float = 0.02,
    start: ArrayLike | None = None,
    start_std: ArrayLike = START_STD,
    rate: float = CYCLE_RATE,
) -> Estimate:
    """robot_pose_ekf: odometry and yaw made relative to the last estimate, the past forgotten.

    The change of the odometry's pose since the last cycle is put on the last estimate, and that is
    measured; likewise the change of the yaw. Their variances are multiplied by dt^2, and each
    prediction adds (1000 m)^2, so the covariance of the estimate before plays no part.

    Source: odom_estimation.cpp of ros-planning/robot_pose_ekf, which Mastalli 2013, eqs. (4.24) to
    (4.27), repeats without the relative measurements.

    Args:
        recording, R_odometry, R_imu, start, start_std, rate: as for `as_printed`.

    Returns:
        The estimate; state x, y, z, roll, pitch, yaw.

    Raises:
        ValueError: a number out of range.
    """
    R = np.array([positive(R_odometry, "R_odometry"), positive(R_imu, "R_imu")])
    reckoned, yaws, steps = _odometry(recording, start, rate)
    moved = odometry.relative(reckoned[:, :-1], reckoned[:, 1:])
    u = np.zeros((*yaws.shape, 2))

    def measured(k: int, dt: float, last: NDArray) -> tuple:
        yaw = last[:, 2] + (yaws[:, k] - yaws[:, k - 1]) if k else None
        return odometry.compose(last, moved[:, k]), yaw, R * dt**2

    return _filtered("its ancestor", reckoned[:, 0], start_std, steps, u, _ANCESTOR_Q, measured)


def _odometry(
    recording: Recording, start: ArrayLike | None, rate: float
) -> tuple[NDArray, NDArray, Increments]:
    """Poses of the odometry (runs, K+1, 3), newest yaws (runs, K), and the increments."""
    poses = dead_reckoning(recording, start=start, rate=rate).pose
    steps = increments(recording, rate, use="latest")
    return poses.reshape(-1, *poses.shape[-2:]), np.atleast_2d(steps.yaw), steps


def _filtered(
    name: str,
    start: NDArray,
    start_std: ArrayLike,
    steps: Increments,
    u: NDArray,
    Q: ArrayLike,
    measured: Callable[[int, float, NDArray], tuple],
) -> Estimate:
    """The filter's estimate with (4.26) and (4.27).

    measured(k, dt, pose before) gives a cycle's pose (runs, 3), yaw (runs,) or None, and the
    variances of both.
    """
    x0, P0 = np.zeros((len(start), 6)), np.zeros((6, 6))
    x0[:, _POSE] = start
    P0[_POSE, _POSE] = numbers(start_std, "start_std", (3,)) ** 2
    filter_ = BatchExtendedKalmanFilter(
        lambda x, u, dt: motion_424(x, u[:, 0], u[:, 1], dt),
        lambda x, u, dt: jacobian_425(x, u[:, 0], u[:, 1], dt),
        None,
        None,
        np.diag(numbers(Q, "Q", (6,))),
        None,
        x0,
        P0,
        angles=(3, 4, 5),
    )
    log, z = Log(filter_.x, filter_.P, steps, _POSE), np.zeros_like(x0)
    for k, dt in enumerate(steps.dt.tolist()):
        last = filter_.x[:, _POSE]
        filter_.predict(u[:, k], dt)
        z[:, _POSE], yaw, variances = measured(k, dt, last)
        filter_.update(z, H=H_ODOM_426, R=variances[0] * np.eye(6))
        if yaw is not None:
            z[:, _POSE] = 0.0
            z[:, 5] = yaw
            filter_.update(z, H=H_IMU_427, R=variances[1] * np.eye(6))
        log.add(filter_.x, filter_.P, None)
    return log.estimate(name, steps.time, steps.left.ndim == 1)
