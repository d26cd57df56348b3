"""The library's parts of the driving machine: odometry, and the filter sample by sample."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive
from backhoe.localisation import odometry
from backhoe.localisation.drives import NOISE, SLIPPING, Noise
from backhoe.localisation.fusion.estimators import GYRO_PERIOD, START_STD, initial
from backhoe.localisation.fusion.fixes import STATION_STD
from backhoe.localisation.fusion.model import ANGLES, Model
from backhoe.localisation.kalman import ExtendedKalmanFilter
from backhoe.machine import BACKHOE, Machine
from backhoe.vehicle.tracks import tracks_twist

CALIBRATED = (SLIPPING, 0.02)
"""Share of the ideal turn rate of the simulated tracks, and how well a calibration knows it [1]."""

TURNING_WALK = 0.005
"""How fast the slip of the real tracks may change [1 per sqrt(s)]: ours."""


class Odometer:
    """Poses from the encoders alone, one sample after another.

    Args:
        machine: its sprocket radius and gauge.
        turning: share of the ideal turn rate that is believed in.

    Raises:
        ValueError: turning is not positive.
    """

    def __init__(self, machine: Machine = BACKHOE, turning: float = SLIPPING) -> None:
        self.machine = machine
        self.gauge = machine.tracks.gauge / positive(turning, "turning", "1")

    def __call__(self, pose: ArrayLike, left: float, right: float, dt: float) -> NDArray:
        """The pose after dt.

        Args:
            pose: x, y, heading, shape (3,) [m, m, rad].
            left, right: measured rates of the sprockets [rad/s].
            dt: since the last sample [s].

        Returns:
            Shape (3,) [m, m, rad].
        """
        v, omega = tracks_twist(left, right, self.machine, gauge=self.gauge)
        return odometry.advance(pose, float(v) * dt, float(omega) * dt)


class Localiser:
    """The pose filter, sample by sample: encoders, gyro and, now and then, a fix.

    Args:
        machine: its sprocket radius and gauge.
        noise: variances of a sample.
        turning: share of the ideal turn rate before the drive, mean and standard deviation.
        turning_walk: how fast the slip may change [1 per sqrt(s)].
        fix_std: of each coordinate of a fix [m].
        gyro_period: time between two updates by the gyro [s].

    Attributes:
        filter: the `kalman.ExtendedKalmanFilter`; its state is that of `fusion.Model`.

    Raises:
        ValueError: a number out of range.
    """

    def __init__(
        self,
        machine: Machine = BACKHOE,
        noise: Noise = NOISE,
        *,
        turning: tuple[float, float] = CALIBRATED,
        turning_walk: float = TURNING_WALK,
        fix_std: float = STATION_STD,
        gyro_period: float = GYRO_PERIOD,
    ) -> None:
        self._turning = turning
        self._gyro_period = positive(gyro_period, "gyro_period", "s")
        self._R_fix = positive(fix_std, "fix_std", "m") ** 2 * np.eye(2)
        self._model = Model(machine, noise, period=0.0, turning_walk=turning_walk)
        self.reset(np.zeros(3))

    @property
    def x(self) -> NDArray:
        """State x, y, psi, bias, turning, turned, shape (6,)."""
        return self.filter.x

    @property
    def P(self) -> NDArray:
        """Its covariance, shape (6, 6)."""
        return self.filter.P

    def reset(self, pose: ArrayLike) -> None:
        """Begin at a pose, shape (3,) [m, m, rad]."""
        pose, model = numbers(pose, "pose", (3,), meaning="x, y, heading"), self._model
        x0, P0 = initial(pose, START_STD, self._turning, model.noise.gyro_bias)
        self.filter = ExtendedKalmanFilter(
            model.f, model.F, None, None, model.Q, None, x0, P0, angles=ANGLES
        )
        self._turn = self._since = 0.0

    def __call__(
        self, left: float, right: float, yaw_rate: float, fix: ArrayLike | None, dt: float
    ) -> NDArray:
        """The pose after dt.

        Args:
            left, right: measured rates of the sprockets [rad/s].
            yaw_rate: by the gyro [rad/s].
            fix: measured x, y of the machine, shape (2,) [m]; None if there is none.
            dt: since the last sample [s].

        Returns:
            Shape (3,) [m, m, rad].
        """
        filter_, model = self.filter, self._model
        filter_.predict(np.array([left * dt, right * dt]), dt)
        self._turn += yaw_rate * dt
        self._since += dt
        if self._since >= self._gyro_period - dt / 2:
            R = model.R_gyro(self._since, dt)
            filter_.update([self._turn], H=model.H_gyro(self._since), R=R)
            model.restart_turn(filter_)
            self._turn = self._since = 0.0
        if fix is not None:
            filter_.update(fix, H=model.H_POSITION, R=self._R_fix)
        return filter_.x[:3].copy()
