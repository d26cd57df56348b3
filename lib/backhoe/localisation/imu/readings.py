"""What a board shows for a true motion, and how an integrated gyroscope drifts for it.

An accelerometer shows the specific force, acceleration minus gravity, in the body's axes: at rest
and level it is (0, 0, +g).

Source: Mastalli 2013, section 4.4.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import alike, generator, instance, numbers
from backhoe.localisation.imu.attitude import rotation
from backhoe.localisation.imu.board import Board


class Readings(NamedTuple):
    """N samples: time (N,) [s], and with shapes (..., N, 3) the rest.

    gyro [rad/s] and accelerometer [m/s^2] are what the board shows; gyro_bias and
    accelerometer_bias their biases in that; gyro_saturated and accelerometer_saturated are true
    where a reading is at the end of its range.
    """

    time: NDArray
    gyro: NDArray
    accelerometer: NDArray
    gyro_bias: NDArray
    accelerometer_bias: NDArray
    gyro_saturated: NDArray
    accelerometer_saturated: NDArray


def specific_force(acceleration: ArrayLike, attitude: ArrayLike, gravity: float = 9.81) -> NDArray:
    """What an ideal accelerometer shows: acceleration minus gravity, seen from the body.

    Args:
        acceleration: of the board in the world, shape (..., 3) [m/s^2].
        attitude: roll, pitch, yaw, shape (..., 3) [rad].
        gravity: g [m/s^2].

    Returns:
        Shape (..., 3) [m/s^2]; (0, 0, +g) at rest and level.

    Raises:
        ValueError: last axis is not 3, or a value is not finite.
    """
    force = numbers(acceleration, "acceleration", (..., 3), meaning="values (x, y, z)")
    upwards = np.array([0.0, 0.0, gravity])
    return np.einsum("...ji,...j->...i", rotation(attitude), force + upwards)


def measure(
    omega: ArrayLike, force: ArrayLike, board: Board, rng: np.random.Generator | int
) -> Readings:
    """Readings of a board for a true motion: truth + bias + noise, in steps, up to the range.

    Args:
        omega: true turning speed in the body's axes at each sample, shape (..., N, 3) [rad/s].
        force: true specific force, the same shape [m/s^2]; leading axes are boards of their own.
        board: its numbers; the samples are 1 / board.rate apart.
        rng: a NumPy generator, or a seed.

    Returns:
        Readings; a reading beyond the range stays at its end and is marked as saturated.

    Raises:
        ValueError: shapes other than (..., N, 3) and equal, not finite, no generator.
        TypeError: board is none.
    """
    omega = numbers(omega, "omega", (..., "N", 3))
    force = numbers(force, "force", (..., "N", 3))
    alike(omega=omega, force=force)
    instance(board, "board", Board, "such as imu.BOARD_1")
    rng = generator(rng)
    gyro, gyro_bias, gyro_end = _sample(omega, board, "gyro", rng)
    shown, bias, end = _sample(force, board, "accelerometer", rng)
    time = np.arange(omega.shape[-2]) * board.dt
    return Readings(time, gyro, shown, gyro_bias, bias, gyro_end, end)


def yaw_drift(board: Board, t: ArrayLike) -> NDArray:
    """Standard deviation of the yaw that comes from integrating a level board's gyroscope.

    Args:
        board: its numbers; resolution and range are left out.
        t: time since the start, shape (...) [s].

    Returns:
        sqrt(noise^2 dt t + (bias t)^2 + walk^2 t^3 / 3), shape (...) [rad].

    Raises:
        ValueError: t negative or not finite.
    """
    t = numbers(t, "t")
    if (t < 0).any():
        raise ValueError(f"t must be 0 s or more, got {t.min()}")
    noise = board.gyro_noise**2 * board.dt * t
    return np.sqrt(noise + (board.gyro_bias * t) ** 2 + board.gyro_bias_walk**2 * t**3 / 3)


def _sample(
    truth: NDArray, board: Board, sensor: str, rng: np.random.Generator
) -> tuple[NDArray, NDArray, NDArray]:
    """One sensor's readings, its bias, and where it is at the end of its range."""
    noise, start, walk, resolution, end = (
        getattr(board, f"{sensor}_{part}")
        for part in ("noise", "bias", "bias_walk", "resolution", "range")
    )
    steps = walk * np.sqrt(board.dt) * rng.standard_normal(truth.shape)
    steps[..., 0, :] = start * rng.standard_normal(truth[..., 0, :].shape)
    bias = np.cumsum(steps, axis=-2)
    shown = truth + bias + noise * rng.standard_normal(truth.shape)
    if resolution:
        shown = resolution * np.rint(shown / resolution)
    return np.clip(shown, -end, end), bias, np.abs(shown) >= end
