"""Block matching against its definition, a known shift and OpenCV; points and their trust."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.lib.stride_tricks import sliding_window_view

from backhoe.perception import stereo
from backhoe.perception.stereo import engine, loops

CHOICES = {"normalised": 0, "sobel": 1}
PLAIN = {"texture": 0, "uniqueness": 0, "speckle": 0}


def smooth_noise(rows, columns, seed=0):
    rng = np.random.default_rng(seed)
    noise = cv2.GaussianBlur(rng.standard_normal((rows, columns)), (0, 0), 1.5)
    return np.uint8(np.clip(127 + 40 * noise / noise.std(), 0, 255))


def shifted_pair(shift, rows=60, columns=220, seed=0):
    """A left picture, and a right one that sees each pixel `shift` columns further left."""
    wide = smooth_noise(rows, columns + 80, seed)
    return wide[:, :columns].copy(), wide[:, shift : columns + shift].copy()


def rocks(data):
    pair = np.load(data / "stereo" / "rocks.npz")
    return pair["left"], pair["right"]


def steps_pair():
    """A far wall with a near block before it, noise in both pictures."""
    rng = np.random.default_rng(4)
    left, right = shifted_pair(20, 200, 420)
    near, near_right = shifted_pair(45, 200, 420, seed=9)
    left[60:150, 230:330], right[60:150, 185:285] = (
        near[60:150, 230:330],
        near_right[60:150, 185:285],
    )
    return [
        np.uint8(np.clip(image + rng.normal(0, 3, image.shape), 0, 255)) for image in (left, right)
    ]


def opencv(left, right, prefilter, speckle=200, left_right=-1, uniqueness=15, texture=10):
    matcher = cv2.StereoBM.create(128, 15)
    matcher.setPreFilterType(CHOICES[prefilter])
    matcher.setPreFilterSize(9)
    matcher.setPreFilterCap(31)
    matcher.setTextureThreshold(texture)
    matcher.setUniquenessRatio(uniqueness)
    matcher.setSpeckleWindowSize(speckle)
    matcher.setSpeckleRange(16)
    matcher.setDisp12MaxDiff(left_right)
    found = matcher.compute(left, right) / 16
    return np.where(found < 0, np.nan, found)


def agreement(ours, theirs):
    """Share of common pixels within half a disparity, and of pixels that only one of both has."""
    both = np.isfinite(ours) & np.isfinite(theirs)
    one = np.isfinite(ours) ^ np.isfinite(theirs)
    return (np.abs(ours - theirs)[both] <= 0.5).mean(), one.sum() / both.sum()


@pytest.fixture(scope="module")
def data(request):
    return request.config.rootpath / "data"


@pytest.mark.parametrize("left_right", [None, 1.0])
@pytest.mark.parametrize("prefilter", stereo.PREFILTERS)
def test_real_rocks_are_matched_as_by_opencv(data, prefilter, left_right):
    left, right = rocks(data)
    ours = stereo.block_match(left, right, prefilter=prefilter, left_right=left_right)
    theirs = opencv(left, right, prefilter, left_right=-1 if left_right is None else 1)
    close, alone = agreement(ours, theirs)
    assert np.isfinite(ours).sum() > 100_000
    assert close >= 0.97 and alone < 0.03


@pytest.mark.parametrize("prefilter", stereo.PREFILTERS)
def test_an_edge_with_noise_is_matched_as_by_opencv(prefilter):
    left, right = steps_pair()
    close, alone = agreement(
        stereo.block_match(left, right, prefilter=prefilter), opencv(left, right, prefilter)
    )
    assert close >= 0.97 and alone < 0.03


def test_with_sobel_opencv_differs_by_its_sixteenths_and_at_equal_costs(data):
    left, right = rocks(data)
    ours = stereo.block_match(left, right, prefilter="sobel", speckle=0)
    theirs = opencv(left, right, "sobel", speckle=0)
    both = np.isfinite(ours) & np.isfinite(theirs)
    assert (np.abs(ours - theirs)[both] <= 1 / 16 + 1e-6).mean() > 0.999


@pytest.mark.parametrize("shift", [0, 1, 37, 63])
def test_a_whole_shift_is_found_everywhere(shift):
    left, right = shifted_pair(shift)
    found = stereo.block_match(left, right, disparities=64, **PLAIN)
    inside = found[7:-7, 63 + 7 : -7]
    assert np.isfinite(inside).all() and np.isnan(found).sum() == found.size - inside.size
    np.testing.assert_allclose(inside, shift, atol=0.5 if shift in (0, 63) else 0.1)


def test_disparities_are_the_least_sums_of_absolute_differences():
    left, right = (smooth_noise(24, 60, seed) for seed in (1, 2))
    found = stereo.block_match(left, right, disparities=32, window=5, prefilter="sobel", **PLAIN)
    a, b = (
        sliding_window_view(np.pad(_sobel(image), 2), (5, 5)).astype(int) for image in (left, right)
    )
    for i, j in np.argwhere(np.isfinite(found)):
        costs = [np.abs(a[i, j] - b[i, j - d]).sum() for d in range(32)]
        assert costs[int(np.rint(found[i, j]))] <= min(costs) or _halfway(costs, found[i, j])


def _halfway(costs, found):
    return found % 1 == 0.5 and min(costs) in (costs[int(found)], costs[int(found) + 1])


def _sobel(image):
    response = cv2.Sobel(image.astype(np.int16), cv2.CV_16S, 1, 0)
    response[:, [0, -1]] = 0
    return np.clip(response, -31, 31)


def test_the_sobel_prefilter_is_the_clipped_derivative():
    image = smooth_noise(40, 50)
    np.testing.assert_array_equal(stereo.prefiltered(image, "sobel"), _sobel(image) + 31)


def test_the_normalised_prefilter_is_the_pixel_less_the_mean_around_it():
    image = smooth_noise(40, 50)
    means = sliding_window_view(np.pad(image.astype(float), 4, "edge"), (9, 9)).mean(axis=(2, 3))
    expected = np.floor(np.clip(image - means, -31, 31) + 0.5) + 31
    found = stereo.prefiltered(image, "normalised")
    assert np.abs(found - expected).max() <= 1 and (found == expected).mean() > 0.99


@pytest.mark.parametrize("prefilter", stereo.PREFILTERS)
def test_a_brighter_eye_sees_the_same(prefilter):
    left, right = shifted_pair(20)
    brighter = np.uint8(np.clip(right, 0, 215) + 40)
    found = [
        stereo.block_match(np.clip(left, 0, 215), eye, disparities=64, prefilter=prefilter)
        for eye in (np.clip(right, 0, 215), brighter)
    ]
    np.testing.assert_array_equal(*found)


def test_without_texture_nothing_is_seen():
    left, right = shifted_pair(20)
    left[20:45, 100:150], right[20:45, 80:130] = 90, 90
    found = stereo.block_match(left, right, disparities=64, normalising=5)
    assert np.isnan(found[30:35, 110:140]).all() and np.isfinite(found[8:12, 80:180]).all()
    assert np.isnan(stereo.block_match(0 * left, 0 * right, disparities=64)).all()


def test_a_pattern_that_repeats_is_not_unique():
    columns = np.arange(220)
    stripes = np.uint8(127.5 + 100 * np.sin(2 * np.pi * columns / 16))[None].repeat(60, axis=0)
    kept = stereo.block_match(stripes, stripes, disparities=64, uniqueness=0)
    assert np.isfinite(kept[10:-10, 80:-10]).all()
    assert np.isnan(stereo.block_match(stripes, stripes, disparities=64)[10:-10, 80:-12]).all()


def test_left_right_consistency_empties_what_only_one_eye_sees():
    left, right = steps_pair()
    hidden = np.s_[75:135, 230 - 22 : 230 - 10]
    loose, strict = (
        stereo.block_match(left, right, uniqueness=0, speckle=0, left_right=most)
        for most in (None, 1)
    )
    assert np.isfinite(loose[hidden]).mean() > 0.9
    assert np.isfinite(strict[hidden]).mean() < 0.5 * np.isfinite(loose[hidden]).mean()
    near = np.s_[75:135, 245:315]
    np.testing.assert_array_equal(strict[near], loose[near])


def test_small_patches_are_dropped_as_by_opencv():
    rng = np.random.default_rng(2)
    disparity = np.float32(
        np.round(cv2.GaussianBlur(rng.standard_normal((90, 120)), (0, 0), 2) * 12)
    )
    disparity[rng.random(disparity.shape) < 0.2] = np.nan
    for largest in (1, 5, 40, 400):
        ours, theirs = disparity.copy(), np.nan_to_num(disparity, nan=-999).astype(np.int16)
        room = np.empty(ours.size, np.int32), np.empty(ours.size, np.int32)
        engine.drop_speckles(ours, largest, 1, *room, np.empty(ours.shape, np.int32))
        cv2.filterSpeckles(theirs, -999, largest, 1)
        np.testing.assert_array_equal(np.nan_to_num(ours, nan=-999), theirs)
    assert 0 < np.isnan(ours).mean() < 1


def test_compiled_loops_do_as_the_plain_ones():
    left, right = shifted_pair(9, 24, 60)
    left[4:15, 20:40] = 77
    plain, fast = {}, {}
    for module, kept in ((loops, plain), (engine, fast)):
        kept["sobel"], kept["normalised"] = np.empty((2, *left.shape), np.uint8)
        module.sobel_response(left, 31, kept["sobel"])
        module.normalised_response(left, 3, 31, kept["normalised"], np.empty(60, np.int32))
        seen = np.empty_like(right)
        module.sobel_response(right, 31, seen)
        disparity, cost = np.full(left.shape, np.nan, np.float32), np.zeros(left.shape, np.uint16)
        room = np.empty((60 - 15, 16), np.uint16)
        mirrored = np.ascontiguousarray(seen[:, ::-1])
        module.match_rows(kept["sobel"], mirrored, 2, 22, 2, 31, 50, 5, room, disparity, cost)
        kept["matched"], kept["cost"] = disparity.copy(), cost.copy()
        module.keep_consistent(disparity, cost, 1.0, np.empty(60, int), np.empty(60, np.float32))
        kept["consistent"] = disparity.copy()
        label = np.empty(left.shape, np.int32)
        module.drop_speckles(disparity, 9, 1.0, *np.empty((2, left.size), np.int32), label)
        kept["final"] = disparity
    for name, values in plain.items():
        np.testing.assert_array_equal(values, fast[name], err_msg=name)
    counts = [np.isfinite(plain[name]).sum() for name in ("matched", "consistent", "final")]
    assert left.size > counts[0] > counts[1] > counts[2] > 0


def test_the_picture_is_matched_alike_in_one_piece_and_in_stripes(monkeypatch):
    from backhoe.perception.stereo import block_matching

    left, right = steps_pair()
    striped = stereo.block_match(left, right)
    monkeypatch.setattr(block_matching, "STRIPES", 1)
    np.testing.assert_array_equal(striped, stereo.block_match(left, right))


F, B = 416.0, 0.4
Q = np.array([[1, 0, 0, -80.0], [0, 1, 0, -60.0], [0, 0, 0, F], [0, 0, 1 / B, 0]])


def test_points_are_opencvs_and_holes_never_become_any():
    rng = np.random.default_rng(0)
    disparity = rng.uniform(1, 100, (120, 160))
    disparity[rng.random(disparity.shape) < 0.3] = np.nan
    disparity[0, :4] = 0, -3, np.inf, -np.inf
    points, pixels = stereo.reproject(disparity, Q)
    theirs = cv2.reprojectImageTo3D(disparity.astype(np.float32), Q)
    assert np.isfinite(points).all() and (points[:, 2] > 0).all()
    assert len(points) == (np.isfinite(disparity) & (disparity > 0)).sum()
    np.testing.assert_allclose(points, theirs[tuple(pixels.T)], rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(points[:, 2], stereo.depth(disparity, F, B)[tuple(pixels.T)])


def test_depth_is_nan_where_there_is_no_disparity():
    z = stereo.depth([[np.nan, 0.0], [-1.0, 127.0]], F, B)
    assert np.isnan(z).sum() == 3 and z[1, 1] == pytest.approx(1.31, abs=0.005)


def test_an_empty_map_gives_no_point():
    assert stereo.reproject(np.full((4, 5), np.nan), Q)[0].shape == (0, 3)


def test_the_deviation_of_depth_is_that_of_a_million_noisy_disparities():
    rng = np.random.default_rng(3)
    for z in (3.0, 6.0, 12.0):
        noisy = stereo.depth(F * B / z + 0.1 * rng.standard_normal(200_000), F, B)
        assert stereo.depth_deviation(z, F, B, 0.1) == pytest.approx(noisy.std(), rel=0.02)
    ratio = stereo.depth_deviation(12.0, F, B, 0.1) / stereo.depth_deviation(6.0, F, B, 0.1)
    assert ratio == pytest.approx(4.0)


def test_the_covariance_is_that_of_noisy_pixels_and_lies_along_the_ray():
    rng = np.random.default_rng(5)
    point = np.array([1.5, -0.8, 8.0])
    u, v, d = F * point[0] / point[2], F * point[1] / point[2], F * B / point[2]
    n = 200_000
    u, v = (x + 0.2 * rng.standard_normal(n) for x in (u, v))
    z = F * B / (d + 0.1 * rng.standard_normal(n))
    cloud = np.stack([u * z / F, v * z / F, z], axis=-1)
    P = stereo.point_covariance(point, F, B, disparity_deviation=0.1, pixel_deviation=0.2)
    np.testing.assert_allclose(P, np.cov(cloud.T), atol=0.02 * P.max())
    axis = np.linalg.eigh(P)[1][:, -1]
    assert abs(axis @ point) / np.linalg.norm(point) > 0.9999
    assert stereo.point_covariance(np.ones((2, 5, 3)), F, B).shape == (2, 5, 3, 3)


GOOD = np.zeros((60, 220), np.uint8)


@pytest.mark.parametrize(
    "arguments, says",
    [
        ({"right": GOOD[:, 1:]}, "left and right must be alike"),
        ({"left": GOOD.astype(float)}, "uint8"),
        ({"left": np.zeros((60, 220, 3), np.uint8)}, "grey picture"),
        ({"disparities": 100}, "multiple of 16"),
        ({"disparities": 0}, "at least 16"),
        ({"disparities": 256}, "270 columns"),
        ({"window": 14}, "odd"),
        ({"window": 1}, "at least 3"),
        ({"window": 61}, "61 rows"),
        ({"window": 33}, "within 60000"),
        ({"cap": 0}, "cap"),
        ({"prefilter": "laplace"}, "normalised, sobel"),
        ({"uniqueness": -1}, "uniqueness"),
        ({"texture": -1}, "texture"),
        ({"speckle": -1}, "speckle"),
        ({"step": 0}, "step"),
        ({"left_right": -1}, "left_right"),
        ({"normalising": 4}, "normalising must be odd"),
    ],
)
def test_bad_input_of_the_matcher_is_named(arguments, says):
    pair = {"left": GOOD, "right": GOOD, "disparities": 64} | arguments
    with pytest.raises(ValueError, match=says):
        stereo.block_match(pair.pop("left"), pair.pop("right"), **pair)


def test_bad_points_are_named():
    with pytest.raises(ValueError, match=r"shape \(4, 4\)"):
        stereo.reproject(np.ones((3, 3)), np.eye(3))
    with pytest.raises(ValueError, match="in front of the camera"):
        stereo.point_covariance([0.0, 0.0, -1.0], F, B)
    with pytest.raises(ValueError, match="baseline"):
        stereo.depth(np.ones(3), F, 0.0)
