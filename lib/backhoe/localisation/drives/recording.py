"""What the encoders and the IMU give on a drive, with their noise, for one run or many at once.

The source gives "N(0, 20e-3)" for encoders and IMU, without units, and says that both publish at
100 Hz. It is read here as the variance of each single sample in SI units: (rad/s)^2 of a sprocket's
rate, (rad/s)^2 of the gyro, rad^2 of the IMU's yaw, (m/s^2)^2 of an accelerometer.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from math import sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, number, numbers, whole
from backhoe.basics.named import named, shown_by_name
from backhoe.localisation.drives.scenarios import SAMPLE_RATE, Truth, truth
from backhoe.machine import BACKHOE, Machine

SEED = 2013
"""Of the recordings, unless told."""

SLIPPING = 0.73
"""Share of the ideal turn rate that tracks give: ours, as measured on the simulated machine."""


@shown_by_name
@dataclass(frozen=True)
class Noise:
    """Variances of a sample, and the bias of the gyro.

    `encoder` [(rad/s)^2] of a sprocket's rate, `gyro` [(rad/s)^2], `yaw` [rad^2], `accelerometer`
    [(m/s^2)^2]; `gyro_bias` [rad/s] is the standard deviation from which a run's bias is drawn.

    Raises:
        ValueError: a value is negative or not finite.
    """

    encoder: float
    gyro: float
    yaw: float
    accelerometer: float
    gyro_bias: float

    def __post_init__(self) -> None:
        for field in fields(self):
            not_negative(getattr(self, field.name), f"Noise.{field.name}")


NOISE = named(
    "NOISE", Noise(encoder=0.02, gyro=0.02, yaw=0.02, accelerometer=0.02, gyro_bias=0.002)
)
"""Mastalli 2013, section 4.6, covariance 0.02 in SI units; the gyro's bias (0.1 deg/s) is ours."""


@dataclass(frozen=True, eq=False)
class Recording:
    """Sensors over a drive, and the truth beside them.

    The samples are taken at the instants `time` (n,) [s]. Of many runs, the sensors and `bias` have
    a leading axis (runs, n) and share one truth.

    Attributes:
        name: of the drive.
        time: shape (n,) [s].
        left, right: measured rates of the sprockets, shape (..., n) [rad/s].
        gyro: measured yaw rate, bias included, shape (..., n) [rad/s].
        yaw: absolute yaw as the IMU of a simulator publishes it, not wrapped, shape (..., n) [rad].
        truth_time: shape (k,) [s].
        truth: x, y, heading, shape (k, 3) [m, m, rad].
        turning: share of the ideal turn rate that the tracks gave; NaN if nobody knows.
        bias: of the gyro, shape (...) [rad/s]; NaN if nobody knows.
        force: accelerometer, forward, left and up, shape (..., n, 3) [m/s^2]; None if not kept.
        machine: whose gauge and sprockets these are.
    """

    name: str
    time: NDArray
    left: NDArray
    right: NDArray
    gyro: NDArray
    yaw: NDArray
    truth_time: NDArray
    truth: NDArray
    turning: float
    bias: NDArray
    force: NDArray | None = None
    machine: Machine = BACKHOE

    @property
    def duration(self) -> float:
        """From the first to the last sample [s]."""
        return float(self.time[-1] - self.time[0])

    def truth_at(self, time: ArrayLike) -> NDArray:
        """Interpolated truth, shape (..., 3) [m, m, rad].

        Args:
            time: shape (...) [s].

        Raises:
            ValueError: a time outside the truth's.
        """
        time = numbers(time, "time")
        first, last = self.truth_time[[0, -1]]
        if not ((time >= first - 1e-9) & (time <= last + 1e-9)).all():
            raise ValueError(f"the truth goes from {first:g} to {last:g} s, got times outside it")
        columns = [np.interp(time, self.truth_time, column) for column in self.truth.T]
        return np.stack(columns, axis=-1)


def record(
    name: str,
    *,
    turning: float = 1.0,
    rate: float = SAMPLE_RATE,
    runs: int | None = None,
    seed: int = SEED,
    noise: Noise = NOISE,
    machine: Machine = BACKHOE,
) -> Recording:
    """Drive a scenario with noisy sensors; the same seed gives the same noise, slip or not.

    Args:
        name: one of SCENARIOS.
        turning: share of the ideal turn rate that the tracks give: 1 without slip, `SLIPPING`
            with. The machine drives the same way; with slip its tracks run that much faster
            against each other.
        rate: samples a second [Hz].
        runs: how many, with noise of their own; None for one without the leading axis.
        seed: of the noise, 0 or more.
        noise: variances and bias.
        machine: gauge and sprockets.

    Returns:
        Sensors and truth.

    Raises:
        ValueError: an unknown scenario, or a turning, rate, runs or seed out of range.
    """
    turning = number(turning, "turning", "1", above=0, most=1)
    motion, tracks = truth(name, rate), machine.tracks
    apart = tracks.gauge / 2 * motion.omega / turning
    sprockets = tuple((motion.v + side) / tracks.sprocket_radius for side in (-apart, apart))
    label = name if turning == 1 else f"{name} with slip"
    return sense(
        label,
        motion,
        sprockets,
        turning=turning,
        runs=runs,
        seed=seed,
        noise=noise,
        machine=machine,
    )


def sense(
    name: str,
    motion: Truth,
    sprockets: tuple[NDArray, NDArray],
    *,
    turning: float = np.nan,
    runs: int | None = None,
    seed: int = SEED,
    noise: Noise = NOISE,
    machine: Machine = BACKHOE,
) -> Recording:
    """Put the noise of encoders and IMU on a true motion.

    Args:
        motion: the truth.
        sprockets: true rates of the left and right one, shape (n,) each [rad/s].
        name, turning, runs, seed, noise, machine: as for `record`; turning NaN if nobody knows.
    """
    seed, shape = whole(seed, "seed", least=0), motion.time.shape
    if runs is not None:
        shape = (whole(runs, "runs", least=1), *shape)
    noisy = _adding(np.random.default_rng(seed), shape)
    bias = noise.gyro_bias * np.random.default_rng([seed, 1]).standard_normal(shape[:-1])
    left, right = (noisy(rate, noise.encoder) for rate in sprockets)
    gyro = noisy(motion.omega, noise.gyro) + bias[..., None]
    yaw = noisy(motion.pose[:, 2], noise.yaw)
    axes = *motion.acceleration.T, np.full_like(motion.v, machine.gravity)
    force = np.stack([noisy(axis, noise.accelerometer) for axis in axes], axis=-1)
    return Recording(
        name=name,
        time=motion.time,
        left=left,
        right=right,
        gyro=gyro,
        yaw=yaw,
        truth_time=motion.time,
        truth=motion.pose,
        turning=turning,
        bias=bias,
        force=force,
        machine=machine,
    )


def _adding(rng: np.random.Generator, shape: tuple[int, ...]) -> Callable:
    def noisy(signal: NDArray, variance: float) -> NDArray:
        return signal + sqrt(variance) * rng.standard_normal(shape)

    return noisy
