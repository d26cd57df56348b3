"""What lesson 08b says, tried: about its scene with other noise, and about other pictures."""

import numpy as np
import pytest

from backhoe.lessons.stereo import pairs
from backhoe.perception import stereo

SEEDS = (3, 11)
INSIDE = np.s_[7:-7, 134:-7]


@pytest.fixture(scope="module", params=SEEDS)
def scene(request):
    return pairs.loading(seed=request.param)


@pytest.fixture(scope="module")
def inside(scene):
    where = np.zeros(scene.left.shape, bool)
    where[INSIDE] = True
    return where


def matched(scene, **settings):
    return stereo.block_match(scene.left, scene.right, **{"left_right": 1.0} | settings)


PLAIN = {"texture": 0, "uniqueness": 0, "speckle": 0, "left_right": None}


def test_a_prefilter_mends_a_short_exposure_and_gains_nothing_without_one(scene):
    rows = np.s_[200:280]
    truth = scene.disparity[rows][7:-7, 134:-7]

    def right(prefilter, eye):
        left = scene.left[rows]
        if prefilter is None:
            costs = _costs(left, eye)
            found = costs.argmin(axis=0)[7:-7, 134:-7]
        else:
            found = stereo.block_match(left, eye, prefilter=prefilter, **PLAIN)[7:-7, 134:-7]
        return (np.abs(found - truth) <= 1).mean()

    even, short = scene.right[rows], np.uint8(0.8 * scene.right[rows])
    assert right(None, short) < right(None, even) - 0.3
    for prefilter in stereo.PREFILTERS:
        assert abs(right(prefilter, short) - right(None, even)) < 0.02


def _costs(left, right):
    left, right = left.astype(float), right.astype(float)
    costs = np.full((128, *left.shape), np.inf)
    for d in range(128):
        difference = np.abs(left[:, d:] - right[:, : left.shape[1] - d])
        sums = np.pad(difference, ((1, 0), (1, 0))).cumsum(0).cumsum(1)
        inner = sums[15:, 15:] - sums[:-15, 15:] - sums[15:, :-15] + sums[:-15, :-15]
        costs[d, 7:-7, d + 7 : left.shape[1] - 7] = inner
    return costs


def test_noise_alone_passes_the_texture_threshold(scene):
    assert np.isfinite(matched(scene, **PLAIN | {"texture": 10})[INSIDE]).all()
    even = np.full((60, 220), 150, np.uint8)
    assert np.isnan(stereo.block_match(even, even, uniqueness=0, speckle=0)).all()


def test_half_of_the_trucks_winners_are_wrong_and_a_fifth_of_what_is_kept(scene, inside):
    truck = inside & scene.shows("truck")
    assert 0.45 < scene.shares(matched(scene, **PLAIN), truck)[1] < 0.6
    answered, wrong = scene.shares(matched(scene), truck)
    assert 0.3 < answered < 0.42 and 0.15 < wrong / answered < 0.27


def test_each_question_takes_wrong_answers_away(scene, inside):
    wrong = [
        scene.shares(matched(scene, **settings), inside)[1]
        for settings in (PLAIN, {"uniqueness": 0, "speckle": 0}, {})
    ]
    assert wrong[1] < 0.65 * wrong[0] and wrong[2] < 0.3 * wrong[1]


def test_more_disparities_bring_the_nearest_depth_closer_and_not_the_farthest_away(scene):
    seen = [
        stereo.depth(matched(scene, disparities=n), scene.focal, scene.baseline)
        for n in (64, 128, 256)
    ]
    far = [np.nanpercentile(z[:, 262:], 99.9) for z in seen]
    assert np.ptp(far) < 0.01 * far[0]
    for n, z in zip((64, 128, 256), seen, strict=True):
        assert np.isnan(z[:, : n - 1 + 7]).all() and np.isfinite(z[:, n - 1 + 7]).any()
        assert np.nanmin(z) >= scene.focal * scene.baseline / (n - 1)


def test_a_bucket_too_near_is_lost_and_wrong_answers_doubled(scene, inside):
    few, more = matched(scene, disparities=48), matched(scene, disparities=64)
    bucket = inside & scene.shows("bucket")
    assert np.isfinite(few[bucket]).mean() < 0.02 < 0.8 < np.isfinite(more[bucket]).mean()
    everywhere = np.isfinite(scene.disparity)
    shares = [scene.shares(d, everywhere) for d in (few, more)]
    assert shares[0][1] / shares[0][0] > 2 * shares[1][1] / shares[1][0]


BANDS = ((4, 6), (6, 8), (8, 11), (11, 15), (15, 22), (22, 40))


def test_the_claimed_deviation_holds_what_it_says():
    """Over six noises: the far band alone has only some ten windows that do not overlap."""
    shares, deviations = [], []
    for seed in range(6):
        scene = pairs.loading(seed=seed)
        d, truth = matched(scene), scene.disparity
        soil = np.isfinite(d) & (scene.shows("terrain") | scene.shows("country"))
        good = soil & (np.abs(d - truth) <= 1)
        assert 1 - good.sum() / soil.sum() < 0.002
        first = np.arange(640) < 380
        sigma = (d - truth)[good & first].std()
        fB = scene.focal * scene.baseline
        z = fB / truth
        for low, high in BANDS:
            here = good & ~first & (z >= low) & (z < high)
            claimed = stereo.depth_deviation(z[here], scene.focal, scene.baseline, sigma)
            error = np.abs(fB / d[here] - z[here])
            shares.append([(error <= k * claimed).mean() for k in (1, 2)])
            deviations.append((d - truth)[here].std())
    one, two = np.reshape(shares, (6, len(BANDS), 2)).mean(axis=0).T
    assert (0.6 < one).all() and (one < 0.8).all() and (0.9 < two).all() and (two < 0.98).all()
    mean = np.reshape(deviations, (6, -1)).mean(axis=0)
    assert mean.max() < 1.6 * mean.min()


def test_wrong_winners_lie_at_edges_and_where_one_eye_is_blind(scene, inside):
    d = matched(scene, **PLAIN)
    wrong = inside & ~scene.shows("truck") & ~(np.abs(d - scene.disparity) <= 1)
    edge = scene.edges() | scene.hidden()
    assert 0.72 < edge[wrong].mean() and edge[inside].mean() < 0.2


def test_a_parabola_locks_to_whole_pixels_and_two_lines_hardly():
    """On a sum of cosines, shifted exactly by their phases; the errors are mean ones."""
    rng = np.random.default_rng(5)
    waves = np.fft.rfftfreq(2048)
    spectrum = np.fft.rfft(rng.standard_normal((80, 2048))) * np.exp(-((9.4 * waves) ** 2) / 2)
    left = np.fft.irfft(spectrum)
    errors = {"parabola": [], "lines": []}
    for shift in (0.2, 0.3, 0.7, 0.8):
        right = np.fft.irfft(spectrum * np.exp(2j * np.pi * waves * shift))
        near = shift > 0.5
        a, b, c = (
            sum(
                np.roll(np.abs(left - np.roll(right, k + near, axis=1)), m, axis=1).sum(axis=0)
                for m in range(15)
            )
            for k in (-1, 0, 1)
        )
        errors["parabola"].append((near + (a - c) / (2 * (a + c - 2 * b)) - shift).mean())
        errors["lines"].append((near + (a - c) / (2 * (np.maximum(a, c) - b)) - shift).mean())
    assert np.abs(errors["parabola"]).min() > 0.07 and np.abs(errors["lines"]).max() < 0.02
    assert list(np.sign(errors["parabola"])) == [-1, -1, 1, 1]


def test_semi_global_matching_answers_more_of_the_truck_and_a_larger_share_wrong(scene, inside):
    truck = inside & scene.shows("truck")
    blocks = scene.shares(matched(scene), truck)
    filled = scene.shares(stereo.semi_global_match(scene.left, scene.right), truck)
    assert filled[0] > 1.7 * blocks[0]
    assert filled[1] / filled[0] > 1.2 * blocks[1] / blocks[0]


def test_what_is_hidden_is_what_a_second_surface_covers():
    """A wall of disparity 30 before one of 10: 20 columns beside it have no place to be seen."""
    truth = np.full((12, 200), 10.0)
    truth[:, 100:140] = 30.0
    pair = pairs.LoadingPair(
        np.zeros((12, 200), np.uint8),
        np.zeros((12, 200), np.uint8),
        truth,
        np.zeros((12, 200), np.uint8),
        ("terrain",),
        500.0,
        0.4,
    )
    hidden = pair.hidden()
    assert hidden[:, 81:99].all() and not hidden[:, 141:].any() and not hidden[:, :79].any()
    assert not hidden[:, 100:140].any()
    edges = pair.edges(5)
    assert edges[:, 97:102].all() and not edges[:, :97].any() and not edges[:, 102:137].any()


def test_shares_count_answers_and_wrong_ones(scene):
    d = np.where(scene.surface == 0, scene.disparity, np.nan)
    d[300:310, 300:310] += 1.5
    where = np.zeros(d.shape, bool)
    where[290:320, 290:320] = True
    d[290] = np.nan
    assert scene.shares(d, where) == pytest.approx((29 / 30, 1 / 9))
    with pytest.raises(ValueError, match="at least one pixel"):
        scene.compare({"it": d}, where)
    row = scene.compare({"it": d}, np.full(d.shape, True)).splitlines()[-1]
    assert row.split()[1] == f"{np.isfinite(d).mean():.1%}"
    with pytest.raises(ValueError, match="name"):
        scene.shows("moon")
