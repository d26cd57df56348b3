"""Semi-global matching against its definition, the truth, and OpenCV."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from backhoe.perception import stereo
from backhoe.perception.stereo import engine, paths


@pytest.fixture(scope="module")
def data(request):
    return request.config.rootpath / "data" / "stereo"


@pytest.fixture(scope="module")
def loading(data):
    pair = dict(np.load(data / "loading.npz"))
    rng = np.random.default_rng(0)
    for eye in ("left", "right"):
        noise = rng.normal(0, 2, pair[eye].shape)
        pair[eye] = np.uint8(np.clip(np.rint(pair[eye] + noise), 0, 255))
    return pair | {"truth": pair["disparity"] / 256}


@pytest.fixture(scope="module")
def matched(loading):
    return stereo.semi_global_match(loading["left"], loading["right"])


def opencv(left, right):
    matcher = cv2.StereoSGBM.create(
        0,
        128,
        5,
        P1=200,
        P2=800,
        disp12MaxDiff=1,
        preFilterCap=63,
        uniquenessRatio=5,
        speckleWindowSize=200,
        speckleRange=1,
        mode=cv2.STEREO_SGBM_MODE_HH,
    )
    found = matcher.compute(left, right) / 16
    return np.where(found < 0, np.nan, found)


def agreement(ours, theirs):
    both = np.isfinite(ours) & np.isfinite(theirs)
    return both.mean(), (np.abs(ours - theirs)[both] <= 0.5).mean()


def test_the_scene_is_matched_as_by_opencv(loading, matched):
    common, close = agreement(matched, opencv(loading["left"], loading["right"]))
    assert common > 0.65 and close >= 0.97


def test_real_rocks_are_matched_as_by_opencv(data):
    pair = np.load(data / "rocks.npz")
    ours = stereo.semi_global_match(pair["left"], pair["right"])
    common, close = agreement(ours, opencv(pair["left"], pair["right"]))
    assert common > 0.7 and close >= 0.97


def test_it_answers_more_pixels_than_blocks_and_most_within_a_pixel(loading, matched):
    blocks = stereo.block_match(loading["left"], loading["right"])
    seen = np.s_[:, 127:]
    assert np.isfinite(matched[seen]).mean() > np.isfinite(blocks[seen]).mean() + 0.05
    error = np.abs(matched - loading["truth"])[np.isfinite(matched)]
    assert np.median(error) < 0.15 and (error > 1).mean() < 0.06


def test_the_blind_strip_has_no_answer(matched):
    assert np.isnan(matched[:, :127]).all() and np.isfinite(matched[:, 127]).any()


def test_a_pair_upside_down_is_matched_alike(loading):
    part = np.s_[260:360, 300:620]
    left, right = loading["left"][part], loading["right"][part]
    upright = stereo.semi_global_match(left, right, disparities=96)
    turned = stereo.semi_global_match(left[::-1].copy(), right[::-1].copy(), disparities=96)
    assert np.isfinite(upright).mean() > 0.4
    np.testing.assert_array_equal(upright, turned[::-1])


def noise(rows, columns, seed):
    return np.random.default_rng(seed).integers(0, 255, (rows, columns), dtype=np.uint8)


def test_costs_are_the_mean_differences_of_windows():
    left, right = noise(9, 14, 1), noise(9, 14, 2)
    costs = np.empty((9, 14, 6), np.uint16)
    engine.window_costs(left, right, 1, costs, np.empty(14, np.int32))
    for d in range(6):
        differences = np.abs(left[:, d:].astype(int) - right[:, : 14 - d])
        means = cv2.blur(differences.astype(float), (3, 3), borderType=cv2.BORDER_REPLICATE)
        np.testing.assert_allclose(costs[:, d:, d], 4 * means, atol=0.51)
        assert (costs[:, :d, d] == paths.OUTSIDE).all()


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("way", [(0, 1), (1, -1), (1, 0), (1, 1)])
def test_a_way_costs_what_the_cheapest_of_all_sequences_costs(way, turned):
    """Every sequence of disparities along the last pixel's way is priced, one by one."""
    rng = np.random.default_rng(3)
    costs, small, large = rng.integers(0, 90, (4, 4, 3), dtype=np.uint16), 7, 30
    total, room = np.zeros_like(costs), np.empty((2, 6, 5), np.uint16)
    steps = np.uint16(small), np.uint16(large)
    engine.add_paths(costs, *way, turned, *steps, total, room)
    step = -np.array(way) if turned else np.array(way)

    def prices(line):
        price = np.zeros((3,) * len(line), int)
        for sequence in np.ndindex(*price.shape):
            jumps = np.abs(np.diff(sequence))
            seen = sum(int(costs[(*at, d)]) for at, d in zip(line, sequence, strict=True))
            price[sequence] = seen + small * (jumps == 1).sum() + large * (jumps > 1).sum()
        return price

    for end in np.ndindex(4, 4):
        line = [np.array(end)]
        while ((line[0] - step >= 0) & (line[0] - step < 4)).all():
            line.insert(0, line[0] - step)
        before = prices(line[:-1]).min() if len(line) > 1 else 0
        cheapest = prices(line).reshape(-1, 3).min(axis=0)
        np.testing.assert_array_equal(total[end], cheapest - before)


def test_the_cheapest_is_refined_by_a_parabola_and_must_be_unique():
    total = np.full((1, 12, 8), 100, np.uint16)
    total[0, :, 2:5] = 40, 10, 20
    total[0, 9, 6] = 10
    disparity, cost = np.empty((1, 12), np.float32), np.zeros((1, 12), np.uint16)
    engine.cheapest(total, 5, disparity, cost)
    assert np.isnan(disparity[0, :7]).all() and np.isnan(disparity[0, 9])
    top = np.polynomial.Polynomial.fit([2, 3, 4], [40, 10, 20], 2).deriv().roots()[0]
    np.testing.assert_allclose(disparity[0, [7, 8, 10, 11]], top, rtol=1e-6)
    assert cost[0, 8] == 10


def test_compiled_loops_do_as_the_plain_ones():
    left, right = noise(8, 20, 5), noise(8, 20, 6)
    kept = []
    for module in (paths, engine):
        costs, total = np.zeros((2, 8, 20, 6), np.uint16)
        module.window_costs(left, right, 1, costs, np.empty(20, np.int32))
        room = np.empty((2, 22, 8), np.uint16)
        for turned in (False, True):
            module.add_paths(costs, 1, -1, turned, np.uint16(9), np.uint16(40), total, room)
        disparity, cost = np.empty((8, 20), np.float32), np.zeros((8, 20), np.uint16)
        module.cheapest(total, 2, disparity, cost)
        kept.append((costs, total, disparity, cost))
    for plain, fast in zip(*kept, strict=True):
        np.testing.assert_array_equal(plain, fast)
    assert 0 < np.isfinite(kept[0][2]).mean() < 1


GOOD = np.zeros((20, 40), np.uint8)


@pytest.mark.parametrize(
    "arguments, says",
    [
        ({"right": GOOD[:, 1:]}, "left and right must be alike"),
        ({"left": GOOD.astype(float)}, "uint8"),
        ({"disparities": 41}, "at most 40"),
        ({"disparities": 1}, "at least 2"),
        ({"window": 4}, "odd"),
        ({"small": -1}, "small"),
        ({"large": 8}, "at least 32"),
        ({"large": 4001}, "at most 4000"),
        ({"uniqueness": 100}, "uniqueness"),
        ({"left_right": -1}, "left_right"),
        ({"speckle": -1}, "speckle"),
        ({"step": 0}, "step"),
    ],
)
def test_bad_input_is_named(arguments, says):
    pair = {"left": GOOD, "right": GOOD, "disparities": 16} | arguments
    with pytest.raises(ValueError, match=says):
        stereo.semi_global_match(pair.pop("left"), pair.pop("right"), **pair)
