"""Radii and gauge of a differential drive from a log with a measured pose.

The heading is psi = psi_0 + (r_R phi_R - r_L phi_L) / b, linear in r_L / b and r_R / b. With these
the heading is known without noise, and the way is linear in b. So two least-squares fits give all
three, as long as the vehicle both travels and turns. On tracks the gauge found is the effective
one: the slip of turning is in it, and the slip of pulling is in the radii.

Reference: G. Antonelli, S. Chiaverini, G. Fusco, "A calibration method for odometry of mobile
robots based on the least-squares technique", IEEE Transactions on Robotics 21 (2005) 994-1004.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers
from backhoe.localisation.odometry.dead_reckoning import integrate
from backhoe.localisation.odometry.tracked import Wheels
from backhoe.machine import BACKHOE, Machine


@dataclass(frozen=True)
class Calibration:
    """Wheels from a log, with what is left unexplained.

    Attributes:
        wheels: radii and gauge [m].
        heading_residual: root mean square of what is left of psi [rad].
        position_residual: the same of x and y together [m].
        slip: share of the belts' way that the ground does not see, left and right, against the
            machine's sprocket radius [1].
        gauge_factor: effective gauge over the machine's own [1].
    """

    wheels: Wheels
    heading_residual: float
    position_residual: float
    slip: tuple[float, float]
    gauge_factor: float


def calibrate(
    left: ArrayLike, right: ArrayLike, pose: ArrayLike, machine: Machine = BACKHOE
) -> Calibration:
    """Fit radii and gauge to encoders and poses of one drive.

    Args:
        left, right: angles of the wheels, not wrapped, shape (n,) [rad].
        pose: measured x, y, psi at the same times, psi not wrapped, shape (n, 3) [m, m, rad].
        machine: what slip and gauge factor are compared with.

    Returns:
        The wheels that explain the drive best.

    Raises:
        ValueError: shapes that do not fit, a value that is not finite, psi that jumps, or a drive
            that does not tell the three numbers apart: without turns to both sides, or straights.
    """
    left, right, pose = _log(left, right, pose)
    turned = np.stack([left - left[0], right - right[0]], axis=-1)
    share, heading_residual = _fit(turned, pose[:, 2:])
    if not (share[0] < 0 < share[1]):
        raise ValueError(
            "the heading does not rise with the right wheel and fall with the left: are left and "
            "right swapped, or is psi clockwise?"
        )
    way = np.diff(turned, axis=0) @ (np.abs(share) / 2)
    turn = np.diff(turned, axis=0) @ share
    shape = integrate((0.0, 0.0, pose[0, 2]), way, turn, 1.0)
    gauge, start_turn, position_residual = _scale_and_turn(shape[:, :2], pose[:, :2])
    if abs(start_turn) > np.pi / 4:
        raise ValueError(
            f"the way lies {start_turn:.2f} rad beside the heading: does psi start from x and count"
            " anticlockwise?"
        )
    wheels = Wheels(-share[0] * gauge, share[1] * gauge, gauge)
    radius = machine.tracks.sprocket_radius
    return Calibration(
        wheels,
        heading_residual,
        position_residual,
        (1 - wheels.left / radius, 1 - wheels.right / radius),
        gauge / machine.tracks.gauge,
    )


def _scale_and_turn(shape: NDArray, measured: NDArray) -> tuple[float, float, float]:
    """Similarity of the plane that lays `shape` (n, 2) on `measured`: scale, turn, residual."""
    z, w = (points[:, 0] + 1j * points[:, 1] for points in (shape, measured))
    z, w = z - z.mean(), w - w.mean()
    factor = np.vdot(z, w) / np.vdot(z, z).real
    residual = np.sqrt(np.mean(np.abs(w - factor * z) ** 2))
    return float(abs(factor)), float(np.angle(factor)), float(residual)


def _fit(columns: NDArray, measured: NDArray) -> tuple[NDArray, float]:
    """Least squares with an offset; coefficients of the columns, root mean square residual."""
    matrix = np.column_stack([columns, np.ones(len(columns))])
    if np.linalg.cond(matrix / np.abs(matrix).max(axis=0).clip(1e-300)) > 1e4:
        raise ValueError(
            "the drive does not tell radii and gauge apart: drive straights and turns to both sides"
        )
    found, *_ = np.linalg.lstsq(matrix, measured[:, 0], rcond=None)
    return found[:-1], float(np.sqrt(np.mean((measured[:, 0] - matrix @ found) ** 2)))


def _log(left: ArrayLike, right: ArrayLike, pose: ArrayLike) -> tuple[NDArray, NDArray, NDArray]:
    left = numbers(left, "left", ("n",), meaning="angles in a row")
    right = numbers(right, "right", left.shape, meaning="as many angles")
    pose = numbers(pose, "pose", (len(left), 3), meaning="as many x, y, psi")
    if len(left) < 4:
        raise ValueError(f"left and right must be rows of 4 or more angles, got {len(left)}")
    jumps = np.abs(np.diff(pose[:, 2]))
    if jumps.max() > np.pi:
        k = int(jumps.argmax())
        raise ValueError(f"psi jumps by {jumps[k]:.2f} rad after row {k}: unwrap it with np.unwrap")
    return left, right, pose
