"""Pictures by rays: their geometry, their texture, and that stereo finds their depth."""

from __future__ import annotations

import numpy as np
import pytest

from backhoe.perception import stereo
from backhoe.perception.camera import Pinhole
from backhoe.perception.picture import Paint, Texture, engine, looking, loops, smooth_noise, view
from backhoe.perception.rays import Body, HeightField, RayCaster
from backhoe.view import shapes

CAMERA = Pinhole.of_view((320, 240), np.radians(60))
F, B = CAMERA.K[0, 0], 0.4
BOX = Body(*shapes.box((4, -0.5, 0), (5, 0.5, 1)))
TEXTURE = Texture.of_noise(3)
SOIL, SHEET = Paint(0.5, 0.3), Paint(0.7)


def ground():
    return HeightField(np.zeros((80, 80)), 0.4, (-16, -16))


def scene(*paints, solid=BOX):
    return RayCaster([ground()], [solid]), paints or (SOIL, SOIL)


def eyes(caster, paints, camera=CAMERA):
    T = looking((0, 0, 2.2), (5, 0, 0.2))
    other = T.copy()
    other[:3, 3] += B * T[:3, 0]
    return [view(caster, camera, pose, paints, TEXTURE) for pose in (T, other)]


def test_a_pixel_has_the_depth_of_the_point_that_projects_there():
    caster, paints = scene()
    T = looking((0, 0.3, 2.2), (5, 0, 0.2))
    lens = Pinhole(CAMERA.K, CAMERA.size, [-0.2, 0.03, 0.001, 0, 0])
    seen = view(caster, lens, T, paints, TEXTURE)
    rows, columns = np.nonzero(np.isfinite(seen.depth))
    rays = np.c_[lens.undistort(np.c_[columns, rows].astype(float)), np.ones(len(rows))]
    points = (rays * seen.depth[rows, columns][:, None]) @ T[:3, :3].T + T[:3, 3]
    on_soil = seen.surface[rows, columns] == 0
    assert np.abs(points[on_soil, 2]).max() < 1e-9
    boxed = points[~on_soil]
    outside = np.maximum([4, -0.5, 0] - boxed, boxed - [5, 0.5, 1]).max(axis=1)
    assert len(boxed) > 500 and np.abs(outside).max() < 1e-9


def test_block_matching_finds_the_true_depth():
    caster, paints = scene()
    left, right = eyes(caster, paints)
    z = stereo.depth(stereo.block_match(left.grey, right.grey, disparities=64), F, B)
    part = np.s_[60:-8, 72:-8]
    found = np.isfinite(z[part])
    error = np.abs(z - left.depth)[part][found]
    assert found.mean() > 0.85 and np.median(error / left.depth[part][found] ** 2 * F * B) < 0.2


def test_a_side_without_texture_is_not_seen():
    solid = Body(*shapes.box((4, -2.5, 0), (5, 2.5, 3)))
    shares = []
    for side in (SHEET, SOIL):
        caster, paints = scene(SOIL, side, solid=solid)
        left, right = eyes(caster, paints)
        d = stereo.block_match(left.grey, right.grey, disparities=64)
        inside = (left.surface == 1)[60:-8, 100:-60]
        shares.append(np.isfinite(d[60:-8, 100:-60][inside]).mean())
    assert shares[0] < 0.35 < 0.85 < shares[1]


def test_a_point_has_the_same_light_from_both_eyes():
    left, right = eyes(*scene())
    rows, columns = np.mgrid[100:230:5, 80:310:5].reshape(2, -1)
    shift = F * B / left.depth[rows, columns]
    other = columns - shift
    j = np.floor(other).astype(int)
    soil = (left.surface[rows, columns] == 0) & (right.surface[rows, j] == 0)
    soil &= right.surface[rows, j + 1] == 0
    a = other - j
    seen = (1 - a) * right.grey[rows, j] + a * right.grey[rows, j + 1]
    apart = np.abs(seen - left.grey[rows, columns])[soil]
    assert soil.sum() > 500 and np.percentile(apart, 95) < 12 and np.ptp(left.grey) > 150


def test_the_noise_repeats_is_smooth_and_comes_from_its_seed():
    noise = smooth_noise(1, pixels=256, side=2.56)
    seam = np.abs(noise[:, 0] - noise[:, -1]).mean()
    inner = np.abs(np.diff(noise, axis=1)).mean()
    assert seam == pytest.approx(inner, rel=0.2)
    np.testing.assert_array_equal(noise, smooth_noise(1, pixels=256, side=2.56))
    assert np.abs(noise - smooth_noise(2, pixels=256, side=2.56)).max() > 1
    power = np.abs(np.fft.rfft2(noise)) ** 2
    waves = np.hypot(np.fft.fftfreq(256, 0.01)[:, None], np.fft.rfftfreq(256, 0.01))
    assert power[waves > 1 / 0.02].sum() < 1e-3 * power.sum()
    assert power[waves < 1 / 2.0].sum() < 1e-2 * power.sum()


def test_coarser_copies_are_means_of_finer_ones():
    texture = Texture.of_noise(0, side=0.64, pixels=64)
    fine = texture.levels[: 64 * 64].reshape(64, 64)
    second = texture.levels[64 * 64 : 64 * 64 + 32 * 32].reshape(32, 32)
    np.testing.assert_allclose(second, fine.reshape(32, 2, 32, 2).mean(axis=(1, 3)))
    at = 0.64 / 64 * (np.array([5, 63]) + 0.5)
    for level, picture in ((0, fine), (1, second)):
        x = at if level == 0 else 0.64 / 32 * (np.array([5, 31]) + 0.5)
        value = loops.texture_at(texture.levels, 64, 0.64, x[0], x[1] + 0.64, 0.01 * 2**level)
        assert value == pytest.approx(picture[[63, 31][level], 5])


def test_the_compiled_light_is_the_plain_one():
    caster, _ = scene()
    rng = np.random.default_rng(0)
    vector = np.c_[np.ones(200), rng.uniform(-0.3, 0.3, (200, 1)), rng.uniform(-0.6, 0.1, (200, 1))]
    hits = caster.cast([0.0, 0.0, 2.0], vector)
    table = np.array([[0.5, 0.3, 0.5], [0.7, 0.2, 0.4]])
    rest = caster.poses, caster.fields, table, TEXTURE.levels, 1024, 10.24, 1 / F
    grey = []
    for module in (loops, engine):
        grey.append(np.empty(200, np.uint8))
        sun = np.array([0.0, 0.6, 0.8])
        module.shade(hits.points, hits.t, vector, hits.surface, hits.normal, *rest, sun, grey[-1])
    np.testing.assert_array_equal(*grey)
    assert len(np.unique(grey[0])) > 30 and set(hits.surface) == {-1, 0, 1}


def test_a_level_camera_looks_where_it_is_told():
    T = looking((1, 2, 3), (4, 6, 3))
    np.testing.assert_allclose(T[:3, 2], [0.6, 0.8, 0], atol=1e-12)
    np.testing.assert_allclose(T[:3, 1], [0, 0, -1], atol=1e-12)
    np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-12)
    assert np.linalg.det(T[:3, :3]) == pytest.approx(1)


@pytest.mark.parametrize(
    "make, error, says",
    [
        (lambda: looking((1, 1, 1), (1, 1, 5)), ValueError, "from above"),
        (lambda: Paint(1.5), ValueError, "brightness"),
        (lambda: Texture.of_noise(0, pixels=100), ValueError, "power of two"),
        (lambda: smooth_noise(-1), ValueError, "seed"),
        (lambda: view(scene()[0], CAMERA, np.eye(4), [SOIL], TEXTURE), ValueError, "each of 2"),
        (lambda: view(scene()[0], None, np.eye(4), [SOIL], TEXTURE), TypeError, "Pinhole"),
        (lambda: view(scene()[0], CAMERA, np.eye(3), [SOIL] * 2, TEXTURE), ValueError, "4, 4"),
    ],
)
def test_bad_input_is_named(make, error, says):
    with pytest.raises(error, match=says):
        make()
