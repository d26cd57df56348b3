"""The pair of cameras of lesson 08a, as it is mounted, and the boards that it is calibrated with.

Nobody mounts two cameras quite parallel, and no two lenses are alike: the lesson finds these
numbers from pictures.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from backhoe import simulation
from backhoe.arm.kinematics import inverse_kinematics
from backhoe.basics.named import named
from backhoe.machine.sensors import STEREO, sensor_pose
from backhoe.perception.camera import Pair, Pinhole, calibrate, chessboard, rotation
from backhoe.perception.picture import View, chessboard_pictures
from backhoe.simulation.render import link_frames
from backhoe.simulation.scene import LOADING
from backhoe.simulation.sight import Sight

__all__ = [
    "COLUMNS",
    "PAIR",
    "ROWS",
    "SQUARE",
    "calibrations",
    "held",
    "photograph",
    "photographed_corners",
    "residuals",
    "taken",
    "to_right",
    "truck_in_view",
    "truck_rail",
]

_LENS = np.array([-0.28, 0.07, 0.0011, -0.0006, 0.0])
_SIZE = (640, 480)

PAIR = named(
    "PAIR",
    Pair(
        Pinhole([[548, 0, 323], [0, 546, 237], [0, 0, 1]], _SIZE, _LENS),
        Pinhole([[541, 0, 316], [0, 543, 245], [0, 0, 1]], _SIZE, 0.9 * _LENS),
        rotation([0.012, -0.025, 0.015]),
        np.array([-0.40, 0.006, -0.010]),
    ),
)

COLUMNS, ROWS, SQUARE = 9, 6, 0.1
"""Inner corners along and across; side of a square [m]."""

_EDGE = 12.0
"""Between a corner of a board that is seen whole and the picture's edge, at least [pixels]."""

_DATA = Path(__file__).resolve().parents[4] / "data" / "stereo"


_POSE, _TIP, _SWING = (0.0, 0.7, 0.0), (6.5, 0.4, 3.6, np.radians(45)), 0.06
"""Where the machine stands [m, rad], the stick's tip and bucket [m, rad], its house [rad]."""

_RAIL = 2.1
"""Length of the truck's wall that both cameras see [m]."""

_LOAD = 0.25
"""Depth of the soil in the truck [m]."""


def truck_in_view(pair: Pair = PAIR) -> tuple[View, View, NDArray]:
    """What both cameras on the cab see of the truck that the machine loads.

    Returns:
        The left and the right view, and the left camera's pose in the world, shape (4, 4) [m].
    """
    with simulation.open_world(backend="analytic") as world:
        world.reset(q=(_SWING, *inverse_kinematics(_TIP)[1:]), pose=_POSE)
        T = sensor_pose(link_frames(world)["swing"], STEREO.mount)
        bed = world.ground.bed
        bed.restore({**bed.snapshot(), "heights": bed.heights + _LOAD})
        sight = Sight(world)
        return (
            sight.look(pair.left, T),
            sight.look(pair.right, T @ np.linalg.inv(to_right(pair))),
            T,
        )


def truck_rail(count: int = 2) -> NDArray:
    """Points along the inner edge of the truck's near wall, from its rear end on for as long as
    both cameras see it, shape (count, 3) [m] in the world."""
    truck = LOADING.truck
    rear, y = truck.x - truck.bed_length / 2, truck.y - truck.bed_width / 2
    x = rear + np.linspace(0.0, _RAIL, count)
    return np.stack([x, np.full(count, y), np.full(count, truck.wall)], axis=-1)


def to_right(pair: Pair) -> NDArray:
    """R and t of a pair as one transform, shape (4, 4) [m]: p_right = T p_left."""
    return np.block([[pair.R, pair.t[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]])


def held(pair: Pair, count: int, seed: int, tilt: float = 0.6) -> NDArray:
    """Poses of a board that both cameras see whole, in the left one's frame.

    Args:
        pair: the cameras.
        count: of poses.
        seed: the same gives the same poses.
        tilt: the board is turned by up to so much about each of three axes [rad].

    Returns:
        Shape (count, 4, 4) [m], for `perception.picture.chessboard_pictures`.
    """
    board = chessboard(COLUMNS, ROWS, SQUARE)
    rng, poses = np.random.default_rng([seed, 8]), []
    while len(poses) < count:
        T = np.eye(4)
        T[:3, :3] = rotation(rng.uniform(-tilt, tilt, 3))
        middle = rng.uniform(1.1, 2.4) * np.r_[rng.uniform([-0.4, -0.4], [0.6, 0.4]), 1.0]
        T[:3, 3] = middle - T[:3, :3] @ board.mean(axis=0)
        if _whole(pair.left, T, board) and _whole(pair.right, to_right(pair) @ T, board):
            poses.append(T)
    return np.array(poses)


def taken(camera: Pinhole, poses: NDArray, seed: int) -> NDArray:
    """Pictures of the board with a sensor's noise of two grey levels, (views, height, width),
    uint8; poses in the camera's frame (views, 4, 4) [m]."""
    clean = chessboard_pictures(camera, poses, COLUMNS, ROWS, SQUARE)
    noise = 2 * np.random.default_rng([seed, 9]).standard_normal(clean.shape)
    return np.clip(np.rint(clean + noise), 0, 255).astype(np.uint8)


def residuals(board: NDArray, corners: NDArray) -> tuple[float, NDArray]:
    """Root mean square, and where corners (views, n, 2) [pixels] are seen, less where the camera
    that they calibrate puts them, (views * n, 2) [pixels]; board (n, 3) [m]."""
    fit = calibrate(board, corners, _SIZE)
    placed = board @ np.swapaxes(fit.rotations, 1, 2) + fit.positions[:, None]
    return fit.rms, (corners - fit.camera.project(placed)).reshape(-1, 2)


def calibrations(
    counts: tuple[int, ...], runs: int, noise: float, seed: int
) -> tuple[NDArray, NDArray]:
    """Calibrate the left camera again and again, with few boards and with many.

    Args:
        counts: boards in a calibration, drawn from thirty.
        runs: calibrations with each of these numbers.
        noise: root mean square of the distance between a corner and where it is found [pixels].
        seed: the same gives the same.

    Returns:
        Errors of fx, shape (counts, runs) [pixels], and the median of the standard deviations that
        the calibrations give themselves, (counts,) [pixels].
    """
    board, rng = chessboard(COLUMNS, ROWS, SQUARE), np.random.default_rng([seed, 10])
    poses = held(PAIR, 30, seed)
    exact = PAIR.left.project(board @ np.swapaxes(poses[:, :3, :3], 1, 2) + poses[:, None, :3, 3])
    errors, said = np.empty((2, len(counts), runs))
    for i, count in enumerate(counts):
        for k in range(runs):
            seen = exact[rng.choice(len(exact), count, replace=False)]
            seen = seen + noise / np.sqrt(2) * rng.standard_normal(seen.shape)
            fit = calibrate(board, seen, _SIZE)
            errors[i, k], said[i, k] = fit.camera.K[0, 0] - PAIR.left.K[0, 0], fit.deviations[0]
    return errors, np.median(said, axis=1)


def photograph() -> NDArray:
    """A real board, 9 x 6 inner corners, in a real room: shape (480, 640), uint8 [grey levels]."""
    return np.load(_DATA / "board.npz")["photograph"]


def photographed_corners() -> NDArray:
    """Of that board, squares of 25 mm, in 14 photographs of 640 x 480, (14, 54, 2) [pixels]."""
    return np.load(_DATA / "corners.npz")["corners"]


def _whole(camera: Pinhole, T: NDArray, board: NDArray) -> bool:
    pixels = camera.project(board @ T[:3, :3].T + T[:3, 3])
    return bool((np.abs(pixels - (np.array(_SIZE) - 1) / 2) < np.array(_SIZE) / 2 - _EDGE).all())
