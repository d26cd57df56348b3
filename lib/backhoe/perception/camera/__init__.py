"""Cameras: the pinhole and its lens, two views of one point, rectification, calibration.

- `pinhole`: projection, distortion and its removal
- `epipolar`: essential and fundamental matrices, triangulation
- `rectification`: a pair made parallel, maps, Q
- `corners`: a board's corners in a picture
- `zhang`, `calibration`: a camera or a pair from such corners
- `rotations`: axis times angle
"""

from backhoe.perception.camera.calibration import (
    Calibration,
    calibrate,
    calibrate_pair,
    chessboard,
)
from backhoe.perception.camera.corners import find_corners
from backhoe.perception.camera.epipolar import (
    cross_matrix,
    eight_points,
    epipolar_lines,
    essential_matrix,
    fundamental_matrix,
    relative_pose,
    triangulate,
)
from backhoe.perception.camera.pinhole import Pinhole
from backhoe.perception.camera.rectification import Pair, Rectified, pixel_map, rectify, remap
from backhoe.perception.camera.rotations import rotation, rotation_vector
from backhoe.perception.camera.zhang import homography

__all__ = [
    "Calibration",
    "Pair",
    "Pinhole",
    "Rectified",
    "calibrate",
    "calibrate_pair",
    "chessboard",
    "cross_matrix",
    "eight_points",
    "epipolar_lines",
    "essential_matrix",
    "find_corners",
    "fundamental_matrix",
    "homography",
    "pixel_map",
    "rectify",
    "relative_pose",
    "remap",
    "rotation",
    "rotation_vector",
    "triangulate",
]
