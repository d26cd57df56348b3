"""Cameras against OpenCV and against what was made; what no camera can answer is refused."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from backhoe.perception import camera
from backhoe.perception.camera import Pair, Pinhole, rotation

SIZE = (640, 480)
LENS = np.array([-0.28, 0.07, 0.0011, -0.0006, 0.01])
LEFT = Pinhole([[540, 0, 322], [0, 536, 238], [0, 0, 1]], SIZE, LENS)
RIGHT = Pinhole([[531, 0, 315], [0, 533, 244], [0, 0, 1]], SIZE, 0.8 * LENS)
R, T = rotation([0.02, -0.03, 0.015]), np.array([-0.4, 0.006, -0.01])
PAIR = Pair(LEFT, RIGHT, R, T)
BOARD = camera.chessboard(9, 6, 0.1)


def points(n=60, seed=0):
    rng = np.random.default_rng(seed)
    return np.stack([rng.uniform(-1.2, 1.2, n), rng.uniform(-1, 1, n), rng.uniform(3, 9, n)], -1)


def board_views(count=12, seed=1, noise=0.0):
    """Pixels of the board in both cameras, all of it in view, (count, n, 2) each."""
    rng, views = np.random.default_rng(seed), []
    while len(views) < count:
        turn = rotation(rng.uniform(-0.5, 0.5, 3))
        at = np.r_[rng.uniform(-0.6, 0.6), rng.uniform(-0.5, 0.5), rng.uniform(1.2, 2.6)]
        placed = (BOARD - BOARD.mean(axis=0)) @ turn.T + at
        both = np.stack([LEFT.project(placed), RIGHT.project(placed @ R.T + T)])
        both += noise * rng.standard_normal(both.shape)
        if (both > 2).all() and (both < [637, 477]).all():
            views.append(both)
    return np.stack(views, axis=1)


def test_points_are_projected_as_by_opencv():
    theirs, _ = cv2.projectPoints(points(), np.zeros(3), np.zeros(3), LEFT.K, LENS)
    np.testing.assert_allclose(LEFT.project(points()), theirs.reshape(-1, 2), rtol=1e-12)


def test_what_is_not_ahead_has_no_pixel():
    pixels = LEFT.project([[0.1, 0.1, 2.0], [0.1, 0.1, 0.0], [0.1, 0.1, -2.0]])
    assert np.isfinite(pixels[0]).all() and np.isnan(pixels[1:]).all()


def test_undistorting_is_the_inverse_of_projecting():
    rays = points()[:, :2] / points()[:, 2:]
    pixels = LEFT.project(np.c_[rays, np.ones(len(rays))])
    np.testing.assert_allclose(LEFT.undistort(pixels), rays, atol=1e-12)
    theirs = cv2.undistortPoints(pixels, LEFT.K, LENS, criteria=(3, 100, 1e-14)).reshape(-1, 2)
    np.testing.assert_allclose(LEFT.undistort(pixels), theirs, atol=1e-10)


def test_a_pixel_that_the_lens_cannot_make_has_no_ray():
    barrel = Pinhole(LEFT.K, SIZE, [-0.5, 0, 0, 0, 0])
    assert np.isfinite(barrel.undistort([322.0, 238.0])).all()
    assert np.isnan(barrel.undistort([5000.0, 238.0])).all()


def test_a_field_of_view_gives_the_focal_length():
    made = Pinhole.of_view(SIZE, np.radians(60))
    assert made.K[0, 0] == pytest.approx(320 / np.tan(np.radians(30)))
    edge = made.undistort([[-0.5, 239.5], [639.5, 239.5]])
    np.testing.assert_allclose(np.degrees(np.arctan(edge[:, 0])), [-30, 30])


def test_rotations_are_rodrigues_and_back():
    rng = np.random.default_rng(2)
    for v in [*rng.uniform(-1.7, 1.7, (20, 3)), np.zeros(3), [1e-9, 0, 0], [0, 0, np.pi - 1e-9]]:
        np.testing.assert_allclose(rotation(v), cv2.Rodrigues(np.asarray(v, float))[0], atol=1e-12)
        np.testing.assert_allclose(camera.rotation_vector(rotation(v)), v, atol=1e-7)
    half = camera.rotation_vector(rotation(np.pi * np.array([0.6, 0.0, 0.8])))
    np.testing.assert_allclose(rotation(half), rotation(np.pi * np.array([0.6, 0, 0.8])), atol=1e-7)


def in_plane(noise=0.0, n=60):
    """The same points in both cameras' plane z = 1."""
    p = points(n)
    q = p @ R.T + T
    rng = np.random.default_rng(3)
    return [x[:, :2] / x[:, 2:] + noise * rng.standard_normal((n, 2)) for x in (p, q)]


def test_matched_points_obey_the_epipolar_constraint():
    x, y = (np.c_[side, np.ones(60)] for side in in_plane())
    assert np.abs(np.einsum("ni,ij,nj->n", y, camera.essential_matrix(R, T), x)).max() < 1e-14
    u, v = x @ LEFT.K.T, y @ RIGHT.K.T
    F = camera.fundamental_matrix(LEFT, RIGHT, R, T)
    distances = (camera.epipolar_lines(F, u[:, :2]) * v).sum(axis=1)
    assert np.abs(distances).max() < 1e-9
    theirs = cv2.computeCorrespondEpilines(u[:, None, :2], 1, F).reshape(-1, 3)
    np.testing.assert_allclose(camera.epipolar_lines(F, u[:, :2]), theirs, rtol=1e-3, atol=1e-6)


def test_eight_points_give_the_fundamental_matrix_as_by_opencv():
    x, y = in_plane(noise=1e-3)
    u, v = x @ LEFT.K[:2, :2] + LEFT.K[:2, 2], y @ RIGHT.K[:2, :2] + RIGHT.K[:2, 2]
    ours, theirs = camera.eight_points(u, v), cv2.findFundamentalMat(u, v, cv2.FM_8POINT)[0]
    theirs /= np.linalg.norm(theirs)
    np.testing.assert_allclose(ours * np.sign(ours[0, 1] * theirs[0, 1]), theirs, atol=1e-6)
    assert abs(np.linalg.det(ours)) < 1e-12


def test_points_of_one_plane_leave_the_fundamental_matrix_open():
    p = points()
    p[:, 2] = 4.0
    u, v = LEFT.project(p), RIGHT.project(p @ R.T + T)
    flat = [Pinhole(c.K, SIZE).project(q) for c, q in ((LEFT, p), (RIGHT, p @ R.T + T))]
    with pytest.raises(ValueError, match="one plane"):
        camera.eight_points(*flat)
    with pytest.raises(ValueError, match="at least 8"):
        camera.eight_points(u[:7], v[:7])


def test_the_pose_is_the_one_of_four_with_the_points_ahead():
    x, y = in_plane()
    found, t = camera.relative_pose(-3 * camera.essential_matrix(R, T), x, y)
    np.testing.assert_allclose(found, R, atol=1e-12)
    np.testing.assert_allclose(t, T / np.linalg.norm(T), atol=1e-12)


def test_points_are_triangulated_as_by_opencv():
    x, y = in_plane()
    np.testing.assert_allclose(camera.triangulate(x, y, R, T), points(), rtol=1e-9)
    x, y = in_plane(noise=1e-3)
    X = cv2.triangulatePoints(np.eye(3, 4), np.c_[R, T], x.T, y.T)
    np.testing.assert_allclose(camera.triangulate(x, y, R, T), (X[:3] / X[3]).T, rtol=1e-6)


def test_parallel_rays_meet_nowhere():
    x = np.array([[0.1, 0.2]])
    assert np.isnan(camera.triangulate(x, x, np.eye(3), [-0.4, 0.0, 0.0])).all()


def test_a_pair_is_rectified_as_by_opencv():
    new = camera.rectify(PAIR)
    R1, R2, *_ = cv2.stereoRectify(LEFT.K, LENS, RIGHT.K, 0.8 * LENS, SIZE, R, T[:, None], flags=0)
    np.testing.assert_allclose(new.R_left, R1, atol=1e-12)
    np.testing.assert_allclose(new.R_right, R2, atol=1e-12)
    plain = [Pinhole(c.K, SIZE) for c in (LEFT, RIGHT)]
    flat = camera.rectify(Pair(*plain, R, T))
    none = np.zeros(5)
    _, _, P1, P2, Q, *_ = cv2.stereoRectify(
        LEFT.K, none, RIGHT.K, none, SIZE, R, T[:, None], flags=cv2.CALIB_ZERO_DISPARITY, alpha=-1
    )
    np.testing.assert_allclose(flat.K, P1[:, :3], rtol=1e-5)
    np.testing.assert_allclose(flat.Q, Q, rtol=1e-5, atol=1e-9)
    assert flat.baseline == pytest.approx(-P2[0, 3] / P2[0, 0])


def test_a_point_lies_in_one_row_of_both_rectified_pictures_and_q_brings_it_back():
    new = camera.rectify(PAIR)
    K = Pinhole(new.K, SIZE)
    p = points()
    left, right = K.project(p @ new.R_left.T), K.project((p @ R.T + T) @ new.R_right.T)
    np.testing.assert_allclose(left[:, 1], right[:, 1], atol=1e-9)
    d = left[:, 0] - right[:, 0]
    X = np.c_[left, d, np.ones(len(d))] @ new.Q.T
    np.testing.assert_allclose(X[:, :3] / X[:, 3:], p @ new.R_left.T, rtol=1e-9)


def test_maps_and_pictures_are_opencvs():
    new = camera.rectify(PAIR)
    ours = camera.pixel_map(LEFT, new.R_left, new.K)
    theirs = cv2.initUndistortRectifyMap(LEFT.K, LENS, new.R_left, new.K, SIZE, cv2.CV_32FC1)
    np.testing.assert_allclose(ours, np.stack(theirs, axis=-1), atol=1e-3)
    rng = np.random.default_rng(1)
    image = np.uint8(cv2.GaussianBlur(rng.uniform(0, 255, (480, 640)), (0, 0), 2))
    mine = camera.remap(image, ours).astype(int)
    yours = cv2.remap(image, *theirs, cv2.INTER_LINEAR).astype(int)
    inside = np.isfinite(camera.remap(image.astype(float), ours))
    assert inside.mean() > 0.7 and np.abs(mine - yours)[inside].max() <= 2
    assert (mine[~inside] == 0).all()
    coloured = camera.remap(np.stack([image] * 3, axis=-1), ours)
    np.testing.assert_array_equal(coloured[..., 1], mine)


def test_the_identity_map_gives_the_picture():
    image = np.random.default_rng(0).uniform(0, 1, (480, 640))
    same = camera.remap(image, camera.pixel_map(Pinhole(LEFT.K, SIZE)))
    np.testing.assert_allclose(same[1:-1, 1:-1], image[1:-1, 1:-1], atol=1e-9)


@pytest.fixture(scope="module")
def photographs(request):
    return np.load(request.config.rootpath / "data" / "stereo" / "corners.npz")["corners"]


def test_real_photographs_are_calibrated_as_by_opencv(photographs):
    board = camera.chessboard(9, 6, 0.025)
    ours = camera.calibrate(board, photographs, SIZE)
    rms, K, D, *_, deviations, _, _ = cv2.calibrateCameraExtended(
        [board.astype(np.float32)] * 14,
        list(photographs),
        SIZE,
        None,
        None,
        criteria=(cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 200, 1e-15),
    )
    assert ours.rms == pytest.approx(rms, rel=1e-6) and ours.rms < 0.5
    np.testing.assert_allclose(ours.camera.K, K, rtol=1e-6)
    np.testing.assert_allclose(ours.camera.distortion, np.ravel(D), rtol=1e-3, atol=1e-6)
    np.testing.assert_allclose(ours.deviations, deviations.ravel()[:9], rtol=1e-3)


def test_the_simulated_pair_comes_back_to_half_a_percent():
    left, right = board_views(noise=0.1)
    pair, rms = camera.calibrate_pair(BOARD, left, right, SIZE)
    for found, truth in ((pair.left, LEFT), (pair.right, RIGHT)):
        np.testing.assert_allclose(np.diag(found.K), np.diag(truth.K), rtol=5e-3)
    assert pair.baseline == pytest.approx(PAIR.baseline, rel=5e-3)
    np.testing.assert_allclose(pair.R, R, atol=2e-3)
    assert rms == pytest.approx(0.1 * np.sqrt(2), rel=0.1)


def test_a_pair_is_calibrated_as_by_opencv():
    left, right = board_views(noise=0.1)
    pair, rms = camera.calibrate_pair(BOARD, left, right, SIZE)
    shape = [BOARD.astype(np.float32)] * len(left)
    theirs = cv2.stereoCalibrate(
        shape,
        list(left.astype(np.float32)),
        list(right.astype(np.float32)),
        pair.left.K,
        pair.left.distortion,
        pair.right.K,
        pair.right.distortion,
        SIZE,
        flags=cv2.CALIB_FIX_INTRINSIC,
        criteria=(cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 200, 1e-15),
    )
    assert rms == pytest.approx(theirs[0], rel=1e-4)
    np.testing.assert_allclose(pair.R, theirs[5], atol=1e-6)
    np.testing.assert_allclose(pair.t, np.ravel(theirs[6]), atol=1e-6)


def test_perfect_corners_give_the_camera_exactly():
    left, _ = board_views(6)
    found = camera.calibrate(BOARD, left, SIZE)
    np.testing.assert_allclose(found.camera.K, LEFT.K, atol=1e-5)
    np.testing.assert_allclose(found.camera.distortion, LENS, atol=1e-5)
    placed = BOARD @ found.rotations[2].T + found.positions[2]
    np.testing.assert_allclose(found.camera.project(placed), left[2], atol=1e-6)


def test_boards_that_are_all_parallel_leave_the_camera_open():
    views = []
    for depth in (1.5, 2.0, 2.5):
        views.append(Pinhole(LEFT.K, SIZE).project(BOARD + np.array([-0.4, -0.3, depth])))
    with pytest.raises(ValueError, match="tilt the board"):
        camera.calibrate(BOARD, views, SIZE)


def _calibrate(board=BOARD, size=SIZE, **changes):
    views = board_views(3)[0]
    for where, value in changes.get("corners", {}).items():
        views[where] = value
    return camera.calibrate(board, views[: changes.get("count", 3)], size)


@pytest.mark.parametrize(
    "changes, says",
    [
        ({"count": 2}, "3 views or more"),
        ({"corners": {(1, 5): (700.0, 20.0)}}, "view 1 corner 5 .* outside"),
        ({"corners": {(1, 5): (np.nan, 20.0)}}, "finite"),
        ({"board": BOARD[:20]}, "20 corners"),
        ({"board": BOARD + np.array([0, 0, 0.1])}, "z = 0"),
        ({"board": BOARD * [1, 0, 0]}, "not in a line"),
        ({"size": (0, 480)}, "size"),
    ],
)
def test_bad_boards_are_named(changes, says):
    with pytest.raises(ValueError, match=says):
        _calibrate(**changes)


@pytest.mark.parametrize(
    "make, error, says",
    [
        (lambda: Pinhole(np.eye(4), SIZE), ValueError, r"shape \(3, 3\)"),
        (lambda: Pinhole(-np.eye(3), SIZE), ValueError, "fx"),
        (lambda: Pinhole(LEFT.K, (640, 0)), ValueError, "size"),
        (lambda: Pinhole(LEFT.K, SIZE, np.zeros(4)), ValueError, "k1, k2, p1, p2, k3"),
        (lambda: Pinhole.of_view(SIZE, 4.0), ValueError, "field_of_view"),
        (lambda: Pair(LEFT, None, R, T), TypeError, "calibrate the pair first"),
        (lambda: Pair(LEFT, RIGHT, 2 * R, T), ValueError, "rotation"),
        (lambda: Pair(LEFT, RIGHT, R, 0 * T), ValueError, "length of t"),
        (lambda: Pair(LEFT, Pinhole(LEFT.K, (320, 240)), R, T), ValueError, "one size"),
        (lambda: camera.rectify(Pair(LEFT, RIGHT, R, -T)), ValueError, "to the right"),
        (lambda: camera.rectify(Pair(LEFT, RIGHT, R, T[[1, 0, 2]])), ValueError, "to the right"),
        (lambda: camera.remap(np.ones(4), np.ones((2, 2))), ValueError, "image must have shape"),
        (lambda: camera.triangulate([[0, 0]], [[0, 0], [1, 1]], R, T), ValueError, "alike"),
        (lambda: camera.chessboard(1, 6, 0.1), ValueError, "columns"),
    ],
)
def test_bad_cameras_are_named(make, error, says):
    with pytest.raises(error, match=says):
        make()
