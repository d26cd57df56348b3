"""What lesson 08a says in strong words, and the numbers that its sentences stand on."""

import numpy as np
import pytest

from backhoe.lessons.stereo import cameras
from backhoe.lessons.stereo.cameras import COLUMNS, PAIR, ROWS, SQUARE
from backhoe.perception import camera
from backhoe.perception.camera import Pinhole

BOARD = camera.chessboard(COLUMNS, ROWS, SQUARE)


@pytest.fixture(scope="module")
def scene():
    return cameras.truck_in_view()


@pytest.fixture(scope="module")
def wall(scene):
    """41 points of the truck's wall in the left and the right camera's frame."""
    T = scene[2]
    p = (cameras.truck_rail(41) - T[:3, 3]) @ T[:3, :3]
    return p, p @ PAIR.R.T + PAIR.t


def test_a_board_gives_two_equations_for_b_in_any_pose():
    B = np.linalg.inv(PAIR.left.K @ PAIR.left.K.T)
    for T in cameras.held(PAIR, 20, 3, tilt=1.0):
        pixels = Pinhole(PAIR.left.K, PAIR.left.size).project(BOARD @ T[:3, :3].T + T[:3, 3])
        h1, h2, _ = camera.homography(BOARD[:, :2], pixels).T
        scale = h1 @ B @ h1
        assert abs(h1 @ B @ h2) < 1e-9 * scale
        assert abs(h2 @ B @ h2 - scale) < 1e-9 * scale


def test_both_ends_of_the_wall_are_in_both_pictures_and_nothing_is_before_them(scene, wall):
    for view, eye, points in zip(scene[:2], (PAIR.left, PAIR.right), wall, strict=True):
        pixels = eye.project(points)
        assert (pixels > 0).all() and (pixels < np.array(eye.size) - 1).all()
        column, row = np.rint(pixels).astype(int).T
        around = [view.depth[row + i, column + j] for i in (-2, 0, 2) for j in (-2, 0, 2)]
        assert (np.min(around, axis=0) > points[:, 2] - 0.12).all()
        edge = np.abs(np.array(around) - points[:, 2]).min(axis=0)
        assert np.median(edge) < 0.03


def test_points_on_the_wall_lie_on_the_edge_that_the_picture_shows(scene, wall):
    """Across the edge the surface changes from the truck's wall to what is behind it."""
    u, v = np.rint(PAIR.left.project(wall[0][4:-4])).astype(int).T
    upper, lower = (scene[0].surface[v + away, u] for away in (-6, 6))
    assert (upper != lower).mean() > 0.8


def test_the_wall_s_middle_sags_below_the_line_between_its_ends(wall):
    seen = PAIR.left.project(wall[0])
    share = (seen[20, 0] - seen[0, 0]) / (seen[-1, 0] - seen[0, 0])
    assert seen[20, 1] - (seen[0, 1] + share * (seen[-1, 1] - seen[0, 1])) > 4  # rows run down


def test_a_negative_k1_pulls_the_more_the_further_out():
    x = np.linspace(0.1, 0.7, 13)
    pulled = x - Pinhole(np.eye(3), (9, 9), [-0.28, 0, 0, 0, 0]).distort(np.c_[x, 0 * x])[:, 0]
    assert (pulled > 0).all() and (np.diff(pulled / x) > 0).all()


def test_the_far_end_is_seen_more_than_30_pixels_from_where_a_pinhole_has_it(wall):
    flat = Pinhole(PAIR.left.K, PAIR.left.size).project(wall[0][-1])
    assert np.linalg.norm(PAIR.left.project(wall[0][-1]) - flat) > 30
    assert flat[0] > 640  # beyond the frame of the new picture


def test_a_left_point_is_seen_on_one_line_at_whatever_depth():
    F = camera.fundamental_matrix(PAIR.left, PAIR.right, PAIR.R, PAIR.t)
    for pixel in np.random.default_rng(2).uniform((0, 0), (640, 480), (20, 2)):
        ray = np.linalg.solve(PAIR.left.K, np.append(pixel, 1.0))
        points = np.geomspace(1.0, 100.0, 20)[:, None] * ray @ PAIR.R.T + PAIR.t
        seen = Pinhole(PAIR.right.K, (640, 480)).project(points)
        line = camera.epipolar_lines(F, pixel)
        assert np.abs(np.c_[seen, np.ones(20)] @ line).max() < 1e-6


def test_with_ten_boards_half_a_per_cent_is_two_deviations():
    for seed in (5, 6):
        errors, said = cameras.calibrations((10,), 10, 0.2, seed)
        assert 2 * said[0] < 0.005 * PAIR.left.K[0, 0]
        assert (np.abs(errors) < 0.005 * PAIR.left.K[0, 0]).mean() > 0.85


def test_a_calibration_says_how_good_it_is_to_within_a_factor_of_two():
    errors, said = cameras.calibrations((4, 9), 16, 0.2, 7)
    ratio = np.sqrt((errors**2).mean(axis=1)) / said
    assert (ratio < 2).all() and (ratio > 0.5).all()


def test_three_boards_are_a_matter_of_luck_and_more_pay_better_than_by_their_number():
    errors, said = cameras.calibrations((3, 6), 12, 0.2, 5)
    assert np.abs(errors[0]).max() > 5 and np.abs(errors[0]).min() < 0.6
    assert said[0] / said[1] > np.sqrt(2)


def test_boards_seen_in_the_middle_only_leave_the_lens_open():
    rng, said = np.random.default_rng(4), []
    poses = cameras.held(PAIR, 10, 2)
    middle = poses.copy()
    middle[:, :3, 3] = [0.0, 0.0, 2.4] - poses[:, :3, :3] @ BOARD.mean(axis=0)
    for held in (poses, middle):
        views = np.array([PAIR.left.project(BOARD @ T[:3, :3].T + T[:3, 3]) for T in held])
        views += 0.14 * rng.standard_normal(views.shape)
        said.append(camera.calibrate(BOARD, views, PAIR.left.size).deviations[4])
    assert said[1] > 2 * said[0]


def test_a_picture_of_half_the_size_has_another_k():
    """Each new pixel is the mean of four: its middle is half a pixel from both."""
    half = np.diag([0.5, 0.5, 1.0]) @ PAIR.left.K - [[0, 0, 0.25], [0, 0, 0.25], [0, 0, 0]]
    p = np.array([[0.3, -0.2, 2.0]])
    there = Pinhole(PAIR.left.K, (640, 480)).project(p)
    np.testing.assert_allclose(Pinhole(half, (320, 240)).project(p), (there + 0.5) / 2 - 0.5)


def test_the_screen_in_the_photograph_shows_boards_that_the_finder_passes_over():
    corners = camera.find_corners(cameras.photograph(), 9, 6)
    assert corners[:, 0].min() > 150  # the screen is left of column 150
    screen = cameras.photograph().copy()
    screen[:, 170:] = 128
    assert camera.find_corners(screen, 9, 6) is None
