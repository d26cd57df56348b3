"""What a board shows for a true motion, and how an integrated gyroscope drifts for it.

An accelerometer shows the specific force, acceleration minus gravity, in the body's axes: at rest
and level it is (0, 0, +g).

Source: Mastalli 2013, section 4.4.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array
from backhoe.localisation.imu.attitude import rotation, triples
from backhoe.localisation.imu.board import Board


class Readings(NamedTuple):
    """N samples: time (N,) [s], and with shapes (..., N, 3) the rest.

    gyro [rad/s] and accelerometer [m/s^2] are what the board shows; gyro_bias and
    accelerometer_bias what it hides in that; gyro_saturated and accelerometer_saturated are true
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
    felt = triples(acceleration, "acceleration", "x, y, z") - np.array([0.0, 0.0, -gravity])
    return np.einsum("...ji,...j->...i", rotation(attitude), felt)


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
        ValueError: shapes other than (..., N, 3) and equal, not finite, no board, no generator.
    """
    omega = triples(omega, "omega", "x, y, z of N samples")
    force = triples(force, "force", "x, y, z of N samples")
    if omega.ndim < 2 or omega.shape != force.shape:
        raise ValueError(
            f"omega and force must both have shape (..., N, 3), got {omega.shape} and {force.shape}"
        )
    if not isinstance(board, Board):
        raise ValueError(f"board must be an imu.Board, such as imu.BOARD_1, got {board!r}")
    rng = _generator(rng)
    b = board
    gyro, gyro_bias, gyro_end = _sample(
        omega, b.gyro_noise, b.gyro_bias, b.gyro_bias_walk, b.gyro_resolution, b.gyro_range, b, rng
    )
    shown, bias, end = _sample(
        force,
        b.accelerometer_noise,
        b.accelerometer_bias,
        b.accelerometer_bias_walk,
        b.accelerometer_resolution,
        b.accelerometer_range,
        b,
        rng,
    )
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
    t = real_array(t, "t must be times in s")
    if not (np.isfinite(t).all() and (t >= 0).all()):
        raise ValueError("t must be finite and not negative, in s")
    noise = board.gyro_noise**2 * board.dt * t
    return np.sqrt(noise + (board.gyro_bias * t) ** 2 + board.gyro_bias_walk**2 * t**3 / 3)


def allan_deviation(samples: ArrayLike, dt: float, taus: ArrayLike) -> NDArray:
    """How much the average over a time tau differs from the next one, over sqrt(2).

    White noise falls with tau^-1/2, a bias that walks rises with tau^1/2, a constant one does not
    show.

    Args:
        samples: readings at rest, shape (..., N).
        dt: time between them, positive [s].
        taus: averaging times, multiples of dt (rounded to them) up to half the record, (L,) [s].

    Returns:
        Shape (..., L), the unit of the samples.

    Raises:
        ValueError: not finite, dt not positive, or a tau below dt or beyond half the record.
    """
    samples = real_array(samples, "samples must be numbers")
    if samples.ndim == 0 or not np.isfinite(samples).all() or not dt > 0:
        raise ValueError("samples must be finite, shape (..., N), and dt positive")
    counts = np.rint(np.atleast_1d(real_array(taus, "taus must be times in s")) / dt).astype(int)
    N = samples.shape[-1]
    if (counts < 1).any() or (counts > N // 2).any():
        raise ValueError(f"taus must be from dt = {dt:g} s to {N // 2 * dt:g} s, got {taus}")
    total = np.concatenate([np.zeros((*samples.shape[:-1], 1)), np.cumsum(samples, -1)], axis=-1)
    found = []
    for m in counts:
        averages = (total[..., m:] - total[..., :-m]) / m
        steps = averages[..., m:] - averages[..., :-m]
        found.append(np.sqrt(np.mean(steps**2, axis=-1) / 2))
    return np.stack(found, axis=-1)


def _sample(
    truth: NDArray,
    noise: float,
    bias: float,
    walk: float,
    resolution: float,
    end: float,
    board: Board,
    rng: np.random.Generator,
) -> tuple[NDArray, NDArray, NDArray]:
    """One sensor's readings, its bias, and where it is at the end of its range."""
    steps = walk * np.sqrt(board.dt) * rng.standard_normal(truth.shape)
    steps[..., 0, :] = bias * rng.standard_normal(truth[..., 0, :].shape)
    hidden = np.cumsum(steps, axis=-2)
    shown = truth + hidden + noise * rng.standard_normal(truth.shape)
    if resolution:
        shown = resolution * np.rint(shown / resolution)
    return np.clip(shown, -end, end), hidden, np.abs(shown) >= end


def _generator(rng: np.random.Generator | int) -> np.random.Generator:
    if isinstance(rng, np.random.Generator):
        return rng
    if isinstance(rng, int | np.integer) and not isinstance(rng, bool) and rng >= 0:
        return np.random.default_rng(rng)
    raise ValueError(f"rng must be a numpy Generator or a seed, got {rng!r}")
