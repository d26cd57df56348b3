"""Pictures by rays: their geometry, their texture, and that stereo finds their depth."""

from __future__ import annotations

import numpy as np
import pytest

from backhoe.perception import stereo
from backhoe.perception.camera import Pinhole, rotation
from backhoe.perception.picture import Paint, Texture, engine, looking, loops, smooth_noise, view
from backhoe.perception.rays import Body, HeightField, RayCaster, raster
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
    rest = caster.scene.bodies, caster.fields, table, TEXTURE.levels, 1024, 10.24, 1 / F
    grey = []
    for module in (loops, engine):
        grey.append(np.empty(200, np.uint8))
        sun = np.array([0.0, 0.6, 0.8])
        module.shade(hits.points, hits.t, vector, hits.surface, hits.normal, *rest, sun, grey[-1])
    np.testing.assert_array_equal(*grey)
    assert len(np.unique(grey[0])) > 30 and set(hits.surface) == {-1, 0, 1}


def cluttered(plain=True):
    """Rough ground, a second field on it, and turned bodies, one of them around the first eye."""
    rng = np.random.default_rng(4)
    fields = [
        HeightField(rng.uniform(0, 0.7, (60, 50)), 0.3, (-4, -9)),
        HeightField(rng.uniform(0.5, 1, (8, 9)), 0.25, (5, 1)),
    ]
    bodies = [
        Body(*shapes.box((-1, -0.6, -0.4), (1, 0.6, 0.4))),
        Body(*shapes.cylinder((0, 0, 0), (1.5, 1, 2), 0.3)),
        Body(*shapes.box((-2, -2, -2), (2, 2, 2))),
    ]
    poses = np.tile(np.eye(4), (3, 1, 1))
    poses[:, :3, :3] = [rotation(turn) for turn in ([0.3, -0.5, 1.1], [2, 0, 0.4], [0.1, 0.2, 0.3])]
    poses[:, :3, 3] = [[4, 1, 1.2], [3, -2, 0.8], [-30, 0, 5]]
    return RayCaster(fields, bodies, poses, plain=plain), [SOIL, SOIL, SOIL, SHEET, SOIL, SOIL]


EYES = {
    "ahead": ((0, 0, 2.2), (5, 0, 0.2)),
    "along the ground": ((-3.5, 0.1, 0.75), (8, 1, 0.7)),
    "from above": ((3, 0.3, 7), (3.2, 0.3, 0)),
    "from below": ((2, 0, -1.5), (5, 1, 2)),
    "inside a box": ((-30, 0, 5), (0, 1, 4)),
    "upwards": ((3, -2, 0.2), (3.3, -2, 9)),
}


@pytest.mark.parametrize("plain", [True, False])
@pytest.mark.parametrize("where", EYES)
def test_a_picture_by_triangles_is_the_picture_by_rays(where, plain):
    caster, paints = cluttered(plain)
    paints, T = paints[: caster.surfaces], looking(*EYES[where])
    seen = view(caster, CAMERA, T, paints, TEXTURE)
    columns, rows = np.meshgrid(np.arange(320), np.arange(240))
    rays = np.c_[
        CAMERA.undistort(np.c_[columns.ravel(), rows.ravel()].astype(float)), np.ones(76800)
    ]
    hits = caster.cast(T[:3, 3], rays @ T[:3, :3].T)
    depth = np.where(np.isfinite(hits.t), hits.t, np.nan).reshape(240, 320)
    same = (np.abs(seen.depth - depth) < 1e-6) | (np.isnan(seen.depth) & np.isnan(depth))
    assert (~same).sum() <= 2, "but for rays along an edge"
    assert (seen.surface.ravel() != hits.surface).sum() <= 2
    bent = Pinhole(CAMERA.K, CAMERA.size, [1e-12, 0, 0, 0, 0])
    other = view(caster, bent, T, paints, TEXTURE)
    assert (other.grey != seen.grey).sum() <= 4


def test_a_triangle_behind_the_camera_is_not_seen():
    corners = np.array([[-1.0, -1, -2], [1, -1, -3], [0, 2, -1]])
    out = np.zeros((4, 5)), np.full((4, 5), -1, np.int32)
    raster.fill(*corners, 7, (2.0, 2.0, 2.0, 2.0), 0, 4, 5, *out)
    assert (out[1] == -1).all()
    raster.fill(*-corners, 7, (2.0, 2.0, 2.0, 2.0), 0, 4, 5, *out)
    assert (out[1] == 7).any()


def test_of_two_surfaces_in_one_place_the_first_is_seen():
    lid = Body(*shapes.box((-1, -1, -0.5), (1, 1, 0.0)))
    caster = RayCaster([HeightField(np.zeros((9, 9)), 0.25, (-1, -1))], [lid])
    seen = view(caster, CAMERA, looking((0.1, 0.2, 1), (0.2, 0.2, 0)), [SOIL, SHEET], TEXTURE)
    down = caster.cast(
        [0.1, 0.2, 1], np.c_[np.random.default_rng(0).uniform(-1, 1, (500, 2)), -2 * np.ones(500)]
    )
    assert set(seen.surface.ravel()) == {0} and set(down.surface) == {0}


def test_the_compiled_picture_is_the_plain_one():
    caster, _ = cluttered()
    K, T = np.array([[20.0, 0, 12], [0, 20, 9], [0, 0, 1]]), looking(*EYES["ahead"])
    nearest, which = caster.covered(K, T, 25)(2, 17)
    plain = np.zeros((15, 25)), np.full((15, 25), -1, np.int32)
    lens = 20.0, 20.0, 12.0, 9.0
    corners, triangles = caster._before(T)
    raster.cover(caster.scene.fields, corners, triangles, lens, 2, 17, 25, *plain)
    np.testing.assert_allclose(plain[0], nearest, rtol=1e-9)
    np.testing.assert_array_equal(plain[1], which)
    table = np.array([[0.5, 0.3, 0.5]] * 6)
    sun, filled = np.array([0.0, 0.6, 0.8]), []
    for module in (loops, engine):
        out = np.empty((15, 25)), np.empty((15, 25), int), np.empty((15, 25), np.uint8)
        how = table, TEXTURE.levels, 1024, 10.24, sun
        with np.errstate(all="ignore"):
            module.show(caster.scene, caster.owners, nearest, which, T, lens, 2, *how, *out)
        filled.append(out)
    for one, other in zip(*filled, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9)
    assert len(set(filled[0][1].ravel())) >= 4


def test_the_light_is_the_suns_share_and_the_shades():
    """A level, even ground: brightness (ambient + (1 - ambient) sun's height), by hand."""
    caster, _ = scene()
    T = looking((-8, 0, 2.2), (-4, 0, 0.2))
    paint = Paint(0.5, ambient=0.4)
    seen = view(caster, CAMERA, T, (paint, paint), TEXTURE)
    height = 0.80 / np.sqrt(0.36**2 + 0.48**2 + 0.80**2)
    expected = 255 * 0.5 * (0.4 + 0.6 * height)
    soil = seen.grey[seen.surface == 0]
    assert len(soil) > 1000 and np.abs(soil - expected).max() <= 0.51


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
        (lambda: Texture(np.zeros(9), 8, 1.0), ValueError, "levels"),
        (lambda: smooth_noise(-1), ValueError, "seed"),
        (lambda: view(scene()[0], CAMERA, np.eye(4), [SOIL], TEXTURE), ValueError, "each of 2"),
        (lambda: view(scene()[0], CAMERA, 2 * np.eye(4), [SOIL] * 2, TEXTURE), ValueError, "rigid"),
        (lambda: view(scene()[0], None, np.eye(4), [SOIL], TEXTURE), TypeError, "Pinhole"),
        (lambda: view(scene()[0], CAMERA, np.eye(3), [SOIL] * 2, TEXTURE), ValueError, "4, 4"),
    ],
)
def test_bad_input_is_named(make, error, says):
    with pytest.raises(error, match=says):
        make()
