"""Odometry, and a filter that knows what odometry is: increments with a noise, not a place.

The encoders drive the motion, the gyro or an absolute yaw corrects heading, slip and bias, and a
fix of the position, when there is one, the rest. Without a fix the uncertainty of the position
grows, because nothing that is measured depends on it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, instance, not_negative, numbers, positive
from backhoe.localisation import odometry
from backhoe.localisation.drives import NOISE, Noise, Recording
from backhoe.localisation.fusion.cycle import CYCLE_RATE, Increments, cycles, increments
from backhoe.localisation.fusion.estimate import Estimate, Log
from backhoe.localisation.fusion.fixes import Fix
from backhoe.localisation.fusion.model import ANGLES, BIAS, PSI, TURNING, Model
from backhoe.localisation.kalman import BatchExtendedKalmanFilter
from backhoe.vehicle.tracks import tracks_twist

HEADINGS = ("rate", "yaw", None)

START_STD = (0.01, 0.01, 0.005)
"""How well the pose at the start is known [m, m, rad]: ours."""

GYRO_PERIOD = 1.0
"""Time between two updates by the gyro [s]: ours; `model` says why not in each cycle."""

TURNING_PRIOR = (0.85, 0.15)
"""What is thought of the slip before the drive, mean and standard deviation [1]: ours."""


def dead_reckoning(
    recording: Recording,
    *,
    turning: float = 1.0,
    start: ArrayLike | None = None,
    rate: float | None = None,
) -> Estimate:
    """Odometry alone: every sample of the encoders, exact arcs.

    Source: Mastalli 2013, eqs. (2.9) and (4.3) and Algorithm 1, corrected.

    Args:
        recording: one run or many.
        turning: share of the ideal turn rate that is believed in; 1 for no slip.
        start: pose at the start, shape (3,) or (runs, 3) [m, m, rad]; default the truth.
        rate: cycles a second, to be beside a filter [Hz]; None for a pose at each sample.

    Returns:
        The poses, without a covariance.

    Raises:
        ValueError: turning is not positive and finite, or start is malformed.
        TypeError: no recording.
    """
    pose = _start(recording, start)
    dt = np.diff(recording.time)
    gauge = recording.machine.tracks.gauge / positive(turning, "turning", "1")
    left, right = (np.atleast_2d(side)[:, 1:] for side in (recording.left, recording.right))
    v, omega = tracks_twist(left, right, recording.machine, gauge=gauge)
    poses = odometry.integrate(pose, v, omega, dt, "exact")
    time = recording.time
    if rate is not None:
        ends = cycles(time, rate)
        time, poses = time[ends], poses[:, ends]
    return Estimate("odometry", time, poses if recording.left.ndim > 1 else poses[0])


def pose_filter(
    recording: Recording,
    *,
    heading: str | None = "rate",
    slip: bool = True,
    turning: float | None = None,
    turning_std: float | None = None,
    start: ArrayLike | None = None,
    start_std: ArrayLike = START_STD,
    fixes: Sequence[Fix] = (),
    noise: Noise = NOISE,
    rate: float = CYCLE_RATE,
    use: str = "all",
    bias_walk: float = 0.0,
    turning_walk: float = 0.0,
    gyro_period: float = GYRO_PERIOD,
) -> Estimate:
    """An extended Kalman filter with the encoders as input.

    Args:
        recording: one run or many.
        heading: what corrects it: the gyro's "rate", the absolute "yaw" of the IMU, or None.
        slip: estimate the share of the ideal turn rate along with the pose; False: it is known.
        turning: that share, as it is thought of before the drive; default the prior's 0.85, or 1
            if slip is False.
        turning_std: its standard deviation before the drive; default the prior's.
        start: pose at the start, shape (3,) or (runs, 3) [m, m, rad]; default the truth.
        start_std: its standard deviations, shape (3,) [m, m, rad].
        fixes: measured positions; each counts in the cycle that ends nearest to its time.
        noise: variances that the filter believes in.
        rate: cycles a second [Hz].
        use: "all" samples or the "latest" of each cycle.
        bias_walk, turning_walk: how fast bias [rad/s/sqrt(s)] and slip [1/sqrt(s)] may wander.
        gyro_period: time between two updates by the gyro [s], at least one cycle.

    Returns:
        The estimate; state x, y, psi, bias, turning, turned.

    Raises:
        ValueError: an unknown heading or use, or a number out of range.
        TypeError: recording or a fix is something else.
    """
    choice(heading, "heading", HEADINGS)
    every = max(round(positive(gyro_period, "gyro_period", "s") * positive(rate, "rate", "Hz")), 1)
    prior = _prior(slip, turning, turning_std)
    bias_std = noise.gyro_bias if heading == "rate" else 0.0
    x0, P0 = initial(_start(recording, start), start_std, prior, bias_std)
    steps = increments(recording, rate, use=use)
    period = float(np.diff(recording.time).mean()) if use == "all" else 0.0
    model = Model(
        recording.machine, noise, period=period, bias_walk=bias_walk, turning_walk=turning_walk
    )
    filter_ = BatchExtendedKalmanFilter(
        model.f, model.F, None, None, model.Q, None, x0, P0, angles=ANGLES
    )
    by_cycle = _by_cycle(fixes, steps)
    turns = np.stack([np.atleast_2d(steps.left), np.atleast_2d(steps.right)], axis=-1)
    log = Log(filter_.x, filter_.P, steps, [0, 1, 2])
    for k, dt in enumerate(steps.dt.tolist()):
        filter_.predict(turns[:, k], dt)
        nis = None
        if heading == "yaw" or (heading == "rate" and (k + 1) % every == 0):
            _update_heading(filter_, model, steps, slice(k + 1 - every, k + 1), heading)
            nis = filter_.nis
        for fix in by_cycle.get(k, ()):
            place = np.broadcast_to(fix.value, (len(filter_.x), 2))
            filter_.update(place, H=model.H_POSITION, R=fix.std**2 * np.eye(2))
        log.add(filter_.x, filter_.P, nis)
    return log.estimate("pose filter", steps.time, recording.left.ndim == 1)


def initial(
    pose: NDArray, start_std: ArrayLike, turning: tuple[float, float], bias_std: float
) -> tuple[NDArray, NDArray]:
    """State and covariance before the drive.

    Args:
        pose: x, y, heading, shape (..., 3) [m, m, rad].
        start_std: standard deviations of the pose, shape (3,) [m, m, rad].
        turning: mean and standard deviation of the share of the ideal turn rate.
        bias_std: of the gyro [rad/s].

    Returns:
        x0, shape (..., 6), and P0, shape (6, 6), in the units of `Model`.
    """
    x0 = np.zeros((*pose.shape[:-1], 6))
    x0[..., :3], x0[..., TURNING] = pose, turning[0]
    std = np.zeros(6)
    std[:3] = [positive(one, "start_std") for one in numbers(start_std, "start_std", (3,))]
    std[BIAS], std[TURNING] = bias_std, turning[1]
    return x0, np.diag(std**2)


def _start(recording: Recording, start: ArrayLike | None) -> NDArray:
    """Where a run begins, shape (runs, 3) or (1, 3): as told, else the truth."""
    instance(recording, "recording", Recording, "drives.load or drives.record gives one")
    runs = len(np.atleast_2d(recording.left))
    pose = recording.truth[0] if start is None else start
    pose = numbers(pose, "start", (3,) if np.ndim(pose) < 2 else (runs, 3), meaning="x, y, heading")
    return np.array(np.broadcast_to(pose, (runs, 3)))


def _prior(slip: bool, turning: float | None, std: float | None) -> tuple[float, float]:
    if turning is None:
        turning = TURNING_PRIOR[0] if slip else 1.0
    if not slip and std is not None:
        raise ValueError("turning_std says that the slip is not known: leave it out, or slip=True")
    spread = not_negative(TURNING_PRIOR[1] if std is None else std, "turning_std", "1")
    return positive(turning, "turning", "1"), spread if slip else 0.0


def _by_cycle(fixes: Sequence[Fix], steps: Increments) -> dict[int, list[Fix]]:
    """Fixes by the cycle, 0 to K - 1, at whose end they count."""
    found = {}
    for fix in fixes:
        instance(fix, "each of fixes", Fix)
        away = np.abs(steps.time[1:] - fix.time)
        cycle = int(away.argmin())
        if away[cycle] > steps.dt.max():
            raise ValueError(f"a fix at {fix.time:g} s is outside the drive")
        found.setdefault(cycle, []).append(fix)
    return found


def _update_heading(
    filter_: BatchExtendedKalmanFilter, model: Model, steps: Increments, last: slice, heading: str
) -> None:
    """Update by the turn that the gyro saw over the last cycles, or by the newest yaw."""
    if heading == "yaw":
        yaw = np.atleast_2d(steps.yaw)[:, last.stop - 1, None]
        filter_.update(yaw, _yaw, model.H_YAW, model.R_yaw(), angles=(0,))
        return
    since = float(steps.dt[last].sum())
    turn = np.atleast_2d(steps.turn)[:, last].sum(axis=1)[:, None]
    R = model.R_gyro(since, float(steps.dt[last.stop - 1]))
    filter_.update(turn, H=model.H_gyro(since), R=R)
    model.restart_turn(filter_)


def _yaw(x: NDArray) -> NDArray:
    return x[..., PSI, None]
