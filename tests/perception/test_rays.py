"""Rays against formulas and brute force, and the compiled loops against the plain ones."""

from __future__ import annotations

import numpy as np
import pytest

from backhoe.perception.camera import rotation
from backhoe.perception.rays import Body, HeightField, RayCaster, engine, loops
from backhoe.view import shapes


def hills(rows=23, columns=31, cell=0.4, seed=0):
    return HeightField(np.random.default_rng(seed).uniform(0, 1.5, (rows, columns)), cell, (-3, -2))


def pose(turn, at):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation(turn), at
    return T


CRATE = Body(*shapes.box((-1, -0.5, -0.25), (1, 0.5, 0.25)))
BAR = Body(*shapes.cylinder((0, 0, 0), (1.5, 1, 2), 0.3))
POSES = np.stack([pose([0.3, -0.5, 1.1], [1, 1, 2.2]), pose([2, 0, 0.4], [4, 3, 1])])


def rays(n, seed=1):
    """From above and from beside, some along an axis, some down a grid's line."""
    rng = np.random.default_rng(seed)
    start = rng.uniform([-4, -3, -1], [10, 8, 5], (n, 3))
    vector = rng.normal(size=(n, 3))
    vector[: n // 10, 2] = 0
    vector[n // 10 : n // 5, :2] = 0
    start[n // 5 : n // 4, 0] = -3 + 0.4 * rng.integers(0, 30, n // 4 - n // 5)
    vector[n // 5 : n // 4, 0] = 0
    return start, vector


def brute_force(triangles, start, vector):
    """First hits by trying all triangles (n, 3, 3) with each ray, by Cramer's rule."""
    a, e, f = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    best = np.full(len(start), np.inf)
    for i, (s, v) in enumerate(zip(start, vector, strict=True)):
        M = np.stack([e, f, np.broadcast_to(-v, e.shape)], axis=-1)
        fine = np.abs(np.linalg.det(M)) > 1e-12
        u, w, t = np.linalg.solve(M[fine], (s - a[fine])[..., None])[..., 0].T
        hit = (u >= -1e-9) & (w >= -1e-9) & (u + w <= 1 + 1e-9) & (t >= 0)
        best[i] = min(t[hit], default=np.inf)
    return best


def test_heightmaps_and_bodies_are_hit_as_by_brute_force():
    field = hills()
    x = -3 + 0.4 * np.arange(31)
    y = -2 + 0.4 * np.arange(23)
    meshes = [shapes.grid(*np.meshgrid(x, y), field.heights)]
    for T, solid in zip(
        POSES,
        (
            shapes.box((-1, -0.5, -0.25), (1, 0.5, 0.25)),
            shapes.cylinder((0, 0, 0), (1.5, 1, 2), 0.3),
        ),
        strict=True,
    ):
        meshes.append((solid[0] @ T[:3, :3].T + T[:3, 3], solid[1]))
    triangles = np.concatenate([vertices[faces] for vertices, faces in meshes])
    start, vector = rays(1200)
    hits = RayCaster([field], [CRATE, BAR], POSES).cast(start, vector)
    expected = brute_force(triangles, start, vector)
    np.testing.assert_array_equal(np.isfinite(hits.t), np.isfinite(expected))
    np.testing.assert_allclose(hits.t, expected, rtol=1e-9, atol=1e-9)
    assert [(hits.surface == k).sum() > 5 for k in range(-1, 3)] == [True] * 4
    assert 0.2 < np.isfinite(hits.t).mean() < 0.9


def test_the_compiled_rays_are_the_plain_ones():
    caster = RayCaster([hills(9, 20), hills(4, 5, 1.0, 3)], [CRATE, BAR], POSES, plain=True)
    start, vector = rays(150)
    found = []
    for module in (loops, engine):
        t, surface, normal = np.empty(150), np.empty(150, int), np.empty((150, 3))
        with np.errstate(all="ignore"):
            module.cast(caster._scene, start, vector, 9.0, t, surface, normal)
        found.append((t, surface, normal))
    np.testing.assert_allclose(found[0][0], found[1][0], rtol=1e-12)
    np.testing.assert_array_equal(found[0][1], found[1][1])
    np.testing.assert_allclose(found[0][2], found[1][2], atol=1e-12)
    assert len(set(found[0][1])) >= 5


def test_a_posed_box_is_hit_where_geometry_says():
    caster = RayCaster([], [CRATE], pose([0, 0, np.pi / 2], [5, 0, 0.25])[None])
    hits = caster.cast([0, 0, 0.3], [[1, 0, 0], [0, 1, 0], [-1, 0, 0]])
    np.testing.assert_allclose(hits.t, [4.5, np.inf, np.inf])
    np.testing.assert_allclose(hits.points[0], [4.5, 0, 0.3])
    np.testing.assert_allclose(hits.normal[0], [-1, 0, 0], atol=1e-12)
    assert np.isnan(hits.points[1:]).all() and hits.surface.tolist() == [0, -1, -1]
    caster.pose(pose([0, 0, 0], [5, 0, 0.25])[None])
    assert caster.cast([0, 0, 0.3], [[1, 0, 0]]).t[0] == pytest.approx(4.0)


def test_rays_end_at_most_and_see_from_below():
    flat = HeightField(np.zeros((3, 3)), 1.0)
    caster = RayCaster([flat])
    down = caster.cast([1, 1, 2], [[0, 0, -1.0]])
    assert down.t[0] == pytest.approx(2.0)
    assert caster.cast([1, 1, 2], [[0, 0, -1.0]], most=1.9).surface[0] == -1
    assert caster.cast([1, 1, -2], [[0, 0, 1.0]]).t[0] == pytest.approx(2.0)


def test_the_plain_goes_on_where_the_first_field_ends():
    caster = RayCaster([HeightField(np.ones((3, 3)), 1.0)], plain=True, reach=50)
    x = np.array([-60.0, -3.0, 1.0, 2.5, 60.0])
    hits = caster.cast(np.c_[x, 0 * x + 1, 0 * x + 4], np.tile([0, 0, -1.0], (5, 1)))
    np.testing.assert_allclose(hits.points[:, 2], [np.nan, 0, 1, 0, np.nan])
    assert hits.surface.tolist() == [-1, 1, 0, 1, -1]


def test_normals_are_those_of_the_slope():
    x, y = np.meshgrid(np.arange(6), np.arange(5))
    caster = RayCaster([HeightField(0.5 * x - 0.25 * y, 1.0)])
    hits = caster.cast([2.2, 1.7, 9], [[0.01, 0.02, -1.0]])
    expected = np.array([-0.5, 0.25, 1]) / np.linalg.norm([0.5, 0.25, 1])
    np.testing.assert_allclose(hits.normal[0], expected, atol=1e-12)
    assert hits.points[0] @ [-0.5, 0.25, 1] == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    "make, says",
    [
        (lambda: HeightField(np.zeros((1, 4)), 1.0), "rows and columns"),
        (lambda: HeightField(np.full((3, 3), np.nan), 1.0), "finite"),
        (lambda: HeightField(np.zeros((3, 3)), 0.0), "cell"),
        (lambda: Body(np.zeros((3, 3)), [[0, 1, 3]]), "indices from 0 to 2"),
        (lambda: RayCaster([], [CRATE], np.eye(4)), r"shape \(1, 4, 4\)"),
        (lambda: RayCaster([], [CRATE], 2 * np.eye(4)[None]), "rigid"),
        (lambda: RayCaster([hills()]).cast([0, 0, 1], np.zeros((2, 3))), "length of a vector"),
        (lambda: RayCaster([hills()]).cast(np.ones((3, 3)), np.ones((2, 3))), "alike"),
        (lambda: RayCaster([hills()]).cast([0, 0, np.nan], np.ones((2, 3))), "finite"),
        (lambda: RayCaster([hills()]).cast([0, 0, 1], np.ones((2, 3)), most=0), "most"),
    ],
)
def test_bad_input_is_named(make, says):
    with pytest.raises(ValueError, match=says):
        make()


def test_only_fields_and_bodies_are_hit():
    with pytest.raises(TypeError, match="HeightField"):
        RayCaster([np.zeros((3, 3))])
    with pytest.raises(TypeError, match="Body"):
        RayCaster([], [np.zeros((3, 3))])
