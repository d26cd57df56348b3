"""What decides each verdict on sections 5.1 and 5.2 of Mastalli: properties, printed forms."""

from functools import cache
from inspect import signature

import cv2
import numpy as np
from scipy import ndimage

from backhoe.lessons.stereo import pairs
from backhoe.perception import picture, rays, stereo
from backhoe.perception.camera import Pinhole
from backhoe.view import shapes

# The prefilter of section 5.2.3


def _noise(rows=60, columns=260, seed=2):
    noise = ndimage.gaussian_filter(np.random.default_rng(seed).standard_normal((rows, columns)), 1)
    return np.uint8(np.clip(120 + 25 * noise / noise.std(), 0, 255))


def response_is_the_clipped_pixel_less_its_surroundings(form):
    image = _noise().astype(float) * 2
    mean = ndimage.uniform_filter(image, 9)
    found = form(image, mean, 31)
    assert np.allclose(found, form(image + 40, mean + 40, 31))
    inside = np.abs(image - mean) < 31
    assert np.allclose(found[inside], (image - mean)[inside]) and 0.2 < inside.mean() < 0.9
    assert np.allclose(found[~inside], 31 * np.sign(image - mean)[~inside])


def clipped_response(I_c, I_mean, I_cap):
    return np.clip(I_c - I_mean, -I_cap, I_cap)


def response_with_the_limits_exchanged(I_c, I_mean, I_cap):
    return np.maximum(np.minimum(I_c - I_mean, -I_cap), I_cap)


def prefilter_is_stereobms_default(kind):
    kinds = {0: "normalised", 1: "sobel"}
    assert kind == kinds[cv2.StereoBM.create(128, 15).getPreFilterType()]


DEFAULT_PREFILTER = "sobel"

# Disparity, and the sum that finds it


def depths_come_out_of_it(disparity):
    """Points ahead, seen by two cameras 0.4 m apart; z = f B / d."""
    f, rng = 500.0, np.random.default_rng(3)
    camera = Pinhole([[f, 0, 320], [0, f, 240], [0, 0, 1]], (640, 480))
    points = rng.uniform([-2, -1, 3], [2, 1, 20], (40, 3))
    left, right = camera.project(points)[:, 0], camera.project(points - [0.4, 0, 0])[:, 0]
    assert np.allclose(f * 0.4 / disparity(left, right), points[:, 2])


def disparity(left, right):
    return -(right - left)


def printed_disparity(left, right):
    return left - right


def disparity_turned(left, right):
    return right - left


def is_least_where_the_disparity_is(sad):
    """x is a disparity x_l - x_r as section 5.2.1 defines it, y zero."""
    left = _noise()
    right = np.roll(left, -17, axis=1)
    window = np.s_[20:35, 120:135]
    costs = [sad(left, right, window, d, 0) for d in range(64)]
    assert int(np.argmin(costs)) == 17


def sad(I_1, I_2, W, x, y):
    rows, columns = W
    moved = slice(columns.start - x, columns.stop - x)
    return np.abs(I_1[W].astype(float) - I_2[rows, moved]).sum()


# The parameters of section 5.2.3


def recover_a_known_shift_in_stereobm(parameters):
    p, left = parameters, _noise(120, 420)
    right = np.roll(left, -41, axis=1)
    assert p["disparities"] % 16 == 0 and p["window"] % 2 == 1
    matcher = cv2.StereoBM.create(p["disparities"], p["window"])
    matcher.setPreFilterType(0)
    matcher.setPreFilterSize(p["normalising"])
    matcher.setPreFilterCap(p["cap"])
    matcher.setTextureThreshold(p["texture"])
    matcher.setSpeckleWindowSize(p["speckle"])
    matcher.setSpeckleRange(1)
    inner = (matcher.compute(left, right) / 16)[10:-10, p["disparities"] + 10 : -60]
    assert (inner > 0).mean() > 0.99 and np.abs(inner - 41).mean() < 0.1


DEFAULTS = {name: p.default for name, p in signature(stereo.block_match).parameters.items()}
PARAMETERS_WITH_100_DISPARITIES = DEFAULTS | {"disparities": 100}


@cache
def _scene(noise=2.0, seed=5):
    return pairs.loading(noise, seed)


@cache
def _opencv(disparities):
    scene = _scene()
    matcher = cv2.StereoBM.create(disparities, 15)
    found = matcher.compute(scene.left, scene.right) / 16
    return np.where(found > 0, scene.focal * scene.baseline / np.maximum(found, 0.1), np.nan)


def end_moves_with_the_number_of_disparities(end):
    share = {"nearest": 1, "farthest": 99}[end]
    few, many = (np.nanpercentile(_opencv(n)[:, 134:], share) for n in (48, 128))
    assert abs(many - few) > 0.2 * few


END_OF_MORE_DISPARITIES, PRINTED_END = "nearest", "farthest"


def drops_most_of_what_noise_alone_answers(threshold):
    """Two grey levels of noise: half of the truck's wrong winners go, 95 % of the soil remains."""
    scene, plain = _scene(), {"uniqueness": 0, "speckle": 0}
    before = stereo.block_match(scene.left, scene.right, texture=0, **plain)
    after = stereo.block_match(scene.left, scene.right, texture=threshold, **plain)
    wrong = scene.shows("truck") & (np.abs(before - scene.disparity) > 1)
    soil = scene.shows("terrain") & np.isfinite(before)
    assert np.isnan(after[wrong]).mean() > 0.5 and np.isfinite(after[soil]).mean() > 0.95


THRESHOLD_ABOVE_THE_NOISE = 600


def drops_wrong_answers_before_right_ones(largest):
    """Of what is dropped five times as large a share is wrong as of what is kept."""
    scene = _scene()
    before = stereo.block_match(scene.left, scene.right, speckle=0)
    after = stereo.block_match(scene.left, scene.right, speckle=largest)
    wrong = np.abs(before - scene.disparity) > 1
    dropped, kept = np.isfinite(before) & np.isnan(after), np.isfinite(after)
    assert dropped.sum() > 200 and wrong[dropped].mean() > 5 * wrong[kept].mean()


SPECKLE, NO_SPECKLE = 200, 0

# What section 5.2.4 sees in its Fig. 5.6


def _winners(scene):
    return stereo.block_match(scene.left, scene.right, texture=0, uniqueness=0, speckle=0)


def errors_are_ten_times_as_frequent_there(place):
    scene = _scene()
    seen = np.isfinite(_winners(scene)) & ~scene.shows("truck")
    wrong, there = np.abs(_winners(scene) - scene.disparity) > 1, place(scene)
    assert wrong[seen & there].mean() > 10 * wrong[seen & ~there].mean()


def contours(scene):
    return scene.edges() | scene.hidden()


def printed_contours(scene):
    d = scene.disparity
    return ndimage.maximum_filter(d, 31) - ndimage.minimum_filter(d, 31) > 8


def surfaces_between_contours(scene):
    return ~contours(scene)


def half_of_the_errors_at_contours_go_without_it(cause):
    def wrong(scene, leave_out=False):
        found = _winners(scene)
        at = contours(scene) & np.isfinite(found) & ~scene.shows("truck")
        return (at & ~leave_out & (np.abs(found - scene.disparity) > 1)).sum()

    scene = _scene()
    without = {
        "one eye alone sees it": lambda: wrong(scene, scene.hidden()),
        "noise of the sensors": lambda: wrong(_scene(0.0)),
    }
    assert without[cause]() < 0.5 * wrong(scene)


CAUSE_AT_CONTOURS, PRINTED_CAUSE = "one eye alone sees it", "noise of the sensors"


def a_side_painted_so_is_reconstructed(paint):
    """A wall 4 m away, before and after; rays give the truth."""
    camera, soil = Pinhole.of_view((320, 240), np.radians(60)), picture.Paint(0.5, 0.3)
    ground = rays.HeightField(np.zeros((80, 80)), 0.4, (-16, -16))
    caster = rays.RayCaster([ground], [rays.Body(*shapes.box((4, -2.5, 0), (5, 2.5, 3)))])
    T = picture.looking((0, 0, 2.2), (5, 0, 0.2))
    other, texture = T.copy(), picture.Texture.of_noise(3)
    other[:3, 3] += 0.4 * T[:3, 0]
    shares = []
    for side in (picture.Paint(0.75), paint):
        eyes = [picture.view(caster, camera, P, (soil, side), texture) for P in (T, other)]
        d = stereo.block_match(eyes[0].grey, eyes[1].grey, disparities=64)[60:-8, 100:-60]
        good = np.abs(d - camera.K[0, 0] * 0.4 / eyes[0].depth[60:-8, 100:-60]) <= 1
        shares.append(good[(eyes[0].surface == 1)[60:-8, 100:-60]].mean())
    assert shares[0] < 0.35 and shares[1] > 0.85


PAINT_WITH_TEXTURE = picture.Paint(0.75, 0.3)
PRINTED_PAINT = picture.Paint(0.75, 0.2)
PAINT_BRIGHTER = picture.Paint(0.95)


def deviation_of_depth_is_that_of_noisy_disparities(deviation):
    """And it passes a laser's 1.2 cm within 10 m: f = 554 pixels, B = 0.4 m, 0.06 pixels."""
    f, B, rng = 554.0, 0.4, np.random.default_rng(1)
    for z in (5.0, 10.0, 20.0):
        noisy = f * B / (f * B / z + 0.06 * rng.standard_normal(100_000))
        assert abs(deviation(z, f, B, 0.06) / noisy.std() - 1) < 0.03
    assert deviation(10.0, f, B, 0.06) > 2 * 0.012


def printed_deviation(z, f, B, sigma):
    return z * z * sigma / (f * B)


def deviation_as_the_depth(z, f, B, sigma):
    return 10 * z * sigma / (f * B)
