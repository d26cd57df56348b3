"""An inertial measurement unit in numbers: rates, ranges, noise, biases, resolution.

Source: Mastalli 2013, for the ranges of two boards (section 4.4) and the rate (section 4.5). Ours
are the resolutions, the range over 12 bits, and noise, bias and its walk, of the size of low-cost
sensors of about 2010, twice as large with the wider range.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import radians

from backhoe.basics.inputs import not_negative, number, positive

STANDARD_GRAVITY = 9.80665
"""What "1 g" of a range means [m/s^2]."""


@dataclass(frozen=True)
class Board:
    """Gyroscope and accelerometer, three axes each, sampled together.

    Attributes:
        rate: samples per second [Hz].
        gyro_range, accelerometer_range: largest reading either way, inf for any [rad/s, m/s^2].
        gyro_noise, accelerometer_noise: standard deviation of one sample [rad/s, m/s^2].
        gyro_bias, accelerometer_bias: standard deviation of the bias at switching on, from then
            constant [rad/s, m/s^2].
        gyro_bias_walk, accelerometer_bias_walk: growth of the bias beside that, a random walk of
            this standard deviation after one second [rad/s/sqrt(s), m/s^2/sqrt(s)].
        gyro_resolution, accelerometer_resolution: step of the readings, 0 for none [rad/s, m/s^2].

    Raises:
        ValueError: rate or a range not positive, another value negative or not a finite number.
    """

    rate: float
    gyro_range: float
    accelerometer_range: float
    gyro_noise: float = 0.0
    accelerometer_noise: float = 0.0
    gyro_bias: float = 0.0
    accelerometer_bias: float = 0.0
    gyro_bias_walk: float = 0.0
    accelerometer_bias_walk: float = 0.0
    gyro_resolution: float = 0.0
    accelerometer_resolution: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name.endswith("range"):
                number(value, field.name, above=0, finite=False)
            else:
                (positive if field.name == "rate" else not_negative)(value, field.name)

    @property
    def dt(self) -> float:
        """Time between two samples [s]."""
        return 1 / self.rate


BOARD_1 = Board(
    rate=100.0,
    gyro_range=radians(120),
    accelerometer_range=1.5 * STANDARD_GRAVITY,
    gyro_noise=radians(0.5),
    accelerometer_noise=0.03,
    gyro_bias=radians(0.5),
    accelerometer_bias=0.05,
    gyro_bias_walk=radians(0.02),
    accelerometer_bias_walk=0.001,
    gyro_resolution=2 * radians(120) / 4096,
    accelerometer_resolution=3 * STANDARD_GRAVITY / 4096,
)
"""Card 1 of the source: 120 deg/s and 1.5 g."""

BOARD_2 = Board(
    rate=100.0,
    gyro_range=radians(500),
    accelerometer_range=6 * STANDARD_GRAVITY,
    gyro_noise=radians(1.0),
    accelerometer_noise=0.06,
    gyro_bias=radians(1.0),
    accelerometer_bias=0.1,
    gyro_bias_walk=radians(0.04),
    accelerometer_bias_walk=0.002,
    gyro_resolution=2 * radians(500) / 4096,
    accelerometer_resolution=12 * STANDARD_GRAVITY / 4096,
)
"""Card 2 of the source: 500 deg/s and 6 g."""
