"""Distances: against SciPy and brute force; spheres against meshes; what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt
from scipy.spatial.transform import Rotation

from backhoe.perception.distance_field import (
    DistanceField,
    clearance,
    covering_spheres,
    distance_transform,
    engine,
    loops,
)
from backhoe.perception.octree import OccupancyOctree

RNG = np.random.default_rng


def some(shape, share, seed):
    grid = RNG(seed).uniform(size=shape) < share
    grid.flat[0] = True
    return grid


class TestTransform:
    @pytest.mark.parametrize(
        "shape", [(30, 41, 22), (1, 1, 50), (60, 1, 2), (5, 70, 5), (40, 33), (1, 9)]
    )
    @pytest.mark.parametrize("share", [0.0, 0.002, 0.1, 0.7])
    def test_it_is_scipys_to_rounding(self, shape, share):
        occupied = some(shape, share, 1)
        wanted = distance_transform_edt(~occupied, sampling=0.1)
        np.testing.assert_allclose(distance_transform(occupied, 0.1), wanted, rtol=1e-14)

    def test_signed_is_minus_the_way_out_within(self):
        occupied = some((20, 24, 18), 0.3, 2)
        inside = distance_transform_edt(occupied)
        found = distance_transform(occupied, 2.0, signed=True)
        np.testing.assert_allclose(found[occupied], -2 * inside[occupied])
        np.testing.assert_allclose(
            found[~occupied], 2 * distance_transform_edt(~occupied)[~occupied]
        )

    def test_nothing_is_infinitely_far_and_everything_too(self):
        nothing = np.zeros((3, 4, 5), bool)
        assert (distance_transform(nothing) == np.inf).all()
        assert (distance_transform(~nothing, signed=True) == -np.inf).all()

    def test_the_grid_that_was_given_is_left_alone(self):
        occupied = some((6, 6, 6), 0.1, 3)
        before = occupied.copy()
        distance_transform(occupied)
        np.testing.assert_array_equal(occupied, before)

    def test_compiled_loops_do_what_the_plain_ones_do(self):
        one = np.where(some((7, 9, 8), 0.03, 4), 0.0, np.inf)
        other = one.copy()
        loops.squared_distances(one)
        engine.squared_distances(other)
        np.testing.assert_array_equal(one, other)


class TestQuery:
    @pytest.fixture
    def field(self):
        return DistanceField(some((20, 24, 18), 0.02, 5), 0.2, [1.0, -2.0, 0.5])

    def test_at_the_middles_it_is_the_transform(self, field):
        index = np.moveaxis(np.indices(field.distances.shape), 0, -1)
        found, _ = field.query(field.corner + 0.2 * index)
        np.testing.assert_allclose(found, field.distances, atol=1e-12)

    def test_it_is_within_a_cells_diagonal_of_the_nearest_middle(self, field):
        points = RNG(6).uniform(field.corner, np.add(field.corner, [3.8, 4.6, 3.4]), (3000, 3))
        middles = field.corner + 0.2 * np.argwhere(field.distances == 0)
        true = np.linalg.norm(points[:, None] - middles, axis=-1).min(axis=1)
        assert np.abs(field.query(points)[0] - true).max() <= 0.2 * 3**0.5 / 2 + 1e-12

    def test_the_gradient_is_that_of_the_distance(self, field):
        points = RNG(7).uniform(
            field.corner + 0.01, np.add(field.corner, [3.7, 4.5, 3.3]), (500, 3)
        )
        _, found = field.query(points)
        for axis, step in enumerate(1e-7 * np.eye(3)):
            ahead, behind = field.query(points + step)[0], field.query(points - step)[0]
            smooth = np.abs((ahead - behind) / 2e-7 - found[:, axis]) < 1e-5
            assert smooth.mean() > 0.99

    def test_it_points_away_from_a_wall(self):
        wall = np.zeros((12, 5, 5), bool)
        wall[0] = True
        distance, gradient = DistanceField(wall, 0.5, [0, 0, 0]).query([[1.3, 1.1, 0.7]])
        assert distance == pytest.approx([1.3])
        assert gradient == pytest.approx(np.array([[1.0, 0.0, 0.0]]))

    def test_outside_it_refuses_or_says_what_it_was_told_to(self, field):
        with pytest.raises(ValueError, match="points must be between"):
            field.query([[0.9, 0.0, 1.0]])
        distance, gradient = field.query([[0.9, 0.0, 1.0], [1.0, -2.0, 0.5]], beyond=np.inf)
        assert distance.tolist() == [np.inf, 0.0] and (gradient[0] == 0).all()

    def test_where_nothing_is_the_distance_is_infinite_and_has_no_gradient(self):
        empty = DistanceField(np.zeros((3, 3, 3), bool), 1.0, [0, 0, 0])
        distance, gradient = empty.query([[0.5, 1.5, 1.0]])
        assert distance.tolist() == [np.inf] and (gradient == 0).all()

    def test_an_octrees_occupied_voxels_are_what_is_near(self):
        tree = OccupancyOctree(0.25)
        points = RNG(8).uniform(-2, 2, (200, 3))
        tree.insert_scan(points, [0.0, 0.0, 0.0])
        field = DistanceField.of_octree(tree, [[-2.5] * 3, [2.5] * 3])
        leaves = tree.leaves()
        full = leaves.centres[leaves.log_odds >= 0]
        assert (leaves.sizes[leaves.log_odds >= 0] == 0.25).all()
        probe = RNG(9).integers(-8, 8, (300, 3)) * 0.25 + 0.125
        true = np.linalg.norm(probe[:, None] - full, axis=-1).min(axis=1)
        np.testing.assert_allclose(field.query(probe)[0], true, atol=1e-9)
        careful = DistanceField.of_octree(tree, [[-2.5] * 3, [2.5] * 3], unknown="occupied")
        unknown = np.isnan(tree.log_odds(probe))
        assert (careful.query(probe[unknown])[0] < 1e-9).all() and unknown.any()
        assert (careful.query(probe)[0] <= field.query(probe)[0] + 1e-9).all()


def barrel(count=24):
    """A closed prism about x, 3 m long and 0.4 m in radius."""
    turn = np.arange(count) * 2 * np.pi / count
    ring = np.column_stack([0 * turn, 0.4 * np.cos(turn), 0.4 * np.sin(turn)])
    vertices = np.concatenate([ring, np.add(ring, [3, 0, 0]), [[0, 0, 0], [3, 0, 0]]])
    i = np.arange(count)
    j = (i + 1) % count
    sides = np.stack([i, j, i + count], 1), np.stack([j, j + count, i + count], 1)
    caps = np.stack([i, j, 0 * i + 2 * count], 1), np.stack([i, j, 0 * i + 1], 1) + count
    caps[1][:, 2] = 2 * count + 1
    return vertices, np.concatenate([*sides, *caps])


def on_surface(vertices, faces, count, rng):
    """Points spread over a mesh."""
    corners = vertices[faces]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    which = rng.choice(len(faces), count, p=area / area.sum())
    shares = rng.dirichlet(np.ones(3), count)
    return np.einsum("nk,nkd->nd", shares, corners[which])


def to_triangles(points, corners):
    """Least distance of each point to any of the triangles (m, 3, 3), by brute force."""
    a, b, c = np.moveaxis(corners, 1, 0)
    best = np.full(len(points), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        t = np.einsum("nmd,md->nm", points[:, None] - start, along) / (along**2).sum(1)
        nearest = start + np.clip(t, 0, 1)[..., None] * along
        best = np.minimum(best, np.linalg.norm(points[:, None] - nearest, axis=-1).min(axis=1))
    normal = np.cross(b - a, c - a)
    height = np.einsum("nmd,md->nm", points[:, None] - a, normal) / np.linalg.norm(normal, axis=1)
    foot = points[:, None] - height[..., None] * normal / np.linalg.norm(normal, axis=1)[:, None]
    within = np.ones(height.shape, bool)
    for start, end in ((a, b), (b, c), (c, a)):
        within &= np.einsum("nmd,md->nm", np.cross(end - start, foot - start), normal) >= 0
    return np.minimum(best, np.where(within, np.abs(height), np.inf).min(axis=1))


class TestClearance:
    @pytest.mark.parametrize("size", [0.15, 0.4, 1.0])
    def test_spheres_cover_the_mesh_and_reach_little_beyond(self, size):
        vertices, faces = barrel()
        spheres = covering_spheres(vertices, faces, size)
        points = np.concatenate([vertices, on_surface(vertices, faces, 20_000, RNG(10))])
        gaps = np.linalg.norm(points[:, None] - spheres[:, :3], axis=-1) - spheres[:, 3]
        assert gaps.min(axis=1).max() < 1e-12
        assert spheres[:, 3].max() <= 2.1 * size

    @pytest.mark.parametrize("seed", range(4))
    def test_it_is_the_least_distance_of_two_meshes_within_what_is_promised(self, seed):
        rng, cell, size = RNG(seed), 0.1, 0.1
        vertices, faces = barrel(12)
        occupied = np.zeros((50, 50, 40), bool)
        for _ in range(3):
            low = rng.integers(0, 35, 3)
            occupied[
                tuple(slice(k, k + w) for k, w in zip(low, rng.integers(2, 6, 3), strict=True))
            ] = True
        field = DistanceField(occupied, cell, [0, 0, 0])
        T = np.eye(4)
        T[:3, :3] = Rotation.random(random_state=seed).as_matrix()
        T[:3, 3] = [2.5, 2.5, 2.0] - T[:3, :3] @ [1.5, 0, 0]
        spheres = covering_spheres(vertices, faces, size)
        found = clearance(field, {"boom": spheres}, {"boom": T}, beyond=np.inf)
        posed = vertices @ T[:3, :3].T + T[:3, 3]
        inside = (posed >= 0).all() and (posed <= [4.9, 4.9, 3.9]).all()
        true = to_triangles(np.argwhere(occupied) * cell, posed[faces]).min()
        assert inside
        assert true - 0.5 * cell * 3**0.5 - 2 * spheres[:, 3].max() <= found.distance
        assert found.distance <= true + 0.5 * cell * 3**0.5 + 1e-9

    def test_it_names_the_nearest_link_and_the_way_out(self):
        wall = np.zeros((40, 20, 20), bool)
        wall[0] = True
        field = DistanceField(wall, 0.1, [0, 0, 0])
        poses = {}
        for link, x in (("stick", 1.0), ("bucket", 3.0)):
            poses[link] = np.eye(4)
            poses[link][:3, 3] = x, 1.0, 1.0
        balls = {"stick": [[0, 0, 0, 0.1]], "bucket": [[0, 0, 0, 0.2], [-2.5, 0, 0, 0.1]]}
        found = clearance(field, balls, poses)
        assert found.link == "bucket" and found.distance == pytest.approx(0.4)
        assert found.point == pytest.approx([0.5, 1.0, 1.0])
        assert found.away == pytest.approx([1.0, 0.0, 0.0])
        del balls["bucket"]
        assert clearance(field, balls, poses).link == "stick"

    def test_the_machines_own_links_are_covered(self):
        from backhoe.view.appearance import visuals

        for parts in visuals().values():
            for part in parts:
                spheres = covering_spheres(part.vertices, part.faces, 0.3)
                points = on_surface(part.vertices, part.faces, 500, RNG(11))
                gaps = np.linalg.norm(points[:, None] - spheres[:, :3], axis=-1) - spheres[:, 3]
                assert gaps.min(axis=1).max() < 1e-9


GRID = np.zeros((3, 3, 3), bool)
FIELD = DistanceField(GRID, 1.0, [0, 0, 0])
BALL, POSE = {"boom": [[0, 0, 0, 0.1]]}, {"boom": np.eye(4)}
TREE = OccupancyOctree(0.1)


@pytest.mark.parametrize(
    "function, words",
    [
        (lambda: distance_transform(np.zeros((3, 3, 3))), "truth values"),
        (lambda: distance_transform(np.zeros(3, bool)), "truth values"),
        (lambda: distance_transform(np.zeros((3, 0), bool)), "truth values"),
        (lambda: distance_transform(GRID, 0), "cell"),
        (lambda: DistanceField(GRID[:1], 1.0, [0, 0, 0]), "voxels of occupied along each"),
        (lambda: DistanceField(GRID, 1.0, [0, 0]), "corner"),
        (lambda: FIELD.query([[0, 0]]), "points"),
        (lambda: FIELD.query([[0, 0, np.nan]]), "points must be finite"),
        (lambda: FIELD.query([[0, 0, 0]], beyond=np.nan), "beyond"),
        (lambda: DistanceField.of_octree(TREE, [[1, 0, 0], [0, 1, 1]]), "box"),
        (lambda: DistanceField.of_octree(TREE, [[-3e3] * 3, [3e3] * 3]), "box"),
        (lambda: DistanceField.of_octree(TREE, [[0] * 3, [1] * 3], unknown="x"), "unknown"),
        (lambda: covering_spheres([[0, 0, 0]], [[0, 0, 1]], 0.1), "faces"),
        (lambda: covering_spheres(np.eye(3), [[0, 1, 2]], 0), "size"),
        (lambda: covering_spheres(np.eye(3), [[0, 1, 2]], 1e-6), "size must be larger"),
        (lambda: clearance(FIELD, {}, {}), "spheres"),
        (lambda: clearance(FIELD, BALL, {}), "poses must have the link 'boom'"),
        (lambda: clearance(FIELD, {"boom": [[0, 0, 0, -1]]}, POSE), "least radius"),
        (lambda: clearance(FIELD, {"boom": [[9, 0, 0, 1]]}, POSE), "points must be between"),
    ],
)
def test_what_is_refused(function, words):
    with pytest.raises(ValueError, match=words):
        function()


def test_a_field_of_another_kind_is_refused():
    with pytest.raises(TypeError, match="field"):
        clearance(GRID, BALL, POSE)
    with pytest.raises(TypeError, match="tree"):
        DistanceField.of_octree(GRID, [[0] * 3, [1] * 3])
