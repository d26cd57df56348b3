"""Wrong input at every public function of perception: `fuzz` says what is tried and allowed."""

from __future__ import annotations

import importlib
import pkgutil
import re
from functools import cache

import numpy as np
import pytest

import backhoe.perception
from backhoe.machine import BACKHOE
from backhoe.machine.sensors import LASERS, STEREO
from backhoe.perception import (
    camera,
    cloud,
    distance_field,
    laser,
    octree,
    picture,
    rays,
    stereo,
    terrain_map,
)
from backhoe.view import shapes
from fuzz import assert_answers_or_names, assert_complete, little_memory, method, public

RNG = np.random.default_rng(0)
LENS = camera.Pinhole.of_view((40, 30), 1.0)
BENT = camera.Pinhole(LENS.K, LENS.size, [-0.2, 0.05, 0.001, 0, 0])
PAIR = camera.Pair(LENS, LENS, np.eye(3), [-0.4, 0.0, 0.0])
FIELD = rays.HeightField(RNG.uniform(0, 1, (9, 11)), 0.5, (-2.0, -2.0))
CRATE_MESH = shapes.box((-1, -1, 0), (1, 1, 1))
CRATE = rays.Body(*CRATE_MESH)
PAINT = picture.Paint(0.5, 0.3)
POINTS = RNG.normal(size=(40, 3))
LEFT, RIGHT = RNG.integers(0, 256, (2, 24, 60)).astype(np.uint8)
BOARD = camera.chessboard(4, 3, 0.1)
SHEETS = np.stack(
    [
        LENS.project((BOARD - [0.15, 0.1, 0]) @ camera.rotation(turn).T + [0, 0, 0.9])
        for turn in ([0.3, 0.1, 0], [-0.2, 0.3, 0.1], [0.1, -0.4, 0.2])
    ]
)
SHEET = np.eye(4)
SHEET[2, 3] = 1.0
PLANE = RNG.uniform(-0.4, 0.4, (12, 2))
OTHER = PLANE + np.c_[RNG.uniform(-0.3, -0.1, 12), np.zeros(12)]
POSE = picture.looking((4, 0, 3), (0, 0, 0))
RESULTS = "Calibration Rectified Hits View Leaves Met Convex Clearance Levels Volume".split()
"""Made by functions, not by hand."""


@cache
def texture() -> picture.Texture:
    return picture.Texture.of_noise(0, 0.64, 16)


def caster() -> rays.RayCaster:
    return rays.RayCaster([FIELD], [CRATE], np.eye(4)[None], plain=True, reach=50.0)


def tree() -> octree.OccupancyOctree:
    made = octree.OccupancyOctree(0.2)
    made.insert_scan(POINTS, [0.0, 0.0, 0.0])
    return made


def ground() -> terrain_map.TerrainMap:
    made = terrain_map.TerrainMap((-2.0, -2.0), 5, 6, 0.8)
    y, x = np.mgrid[-2:1.3:0.2, -2:2.1:0.2].reshape(2, -1)
    made.insert(np.c_[x, y, 0.1 * x], [0.0, 0.0, 3.0])
    return made


def field() -> distance_field.DistanceField:
    occupied = np.zeros((5, 6, 7), bool)
    occupied[2, 3, 1] = True
    return distance_field.DistanceField(occupied, 0.5, (0.0, 0.0, 0.0))


def motion() -> laser.Motion:
    return laser.Motion(np.array([0.0, 1.0, 2.0]), np.eye(3, 4), np.eye(3))


def calls(folder) -> dict[str, tuple]:
    """A function and its arguments under its name, every one of them."""
    tree().save(folder / "good.ot")
    left, right = {"left": PLANE, "right": OTHER}, {"R": np.eye(3), "t": np.array([0.3, 0.1, 0.0])}
    match = {"disparities": 16, "window": 5, "prefilter": "sobel", "cap": 31, "normalising": 9}
    sure = {"texture": 10.0, "uniqueness": 15, "speckle": 20, "step": 1.0, "left_right": 1.0}
    box = cloud.box([0, 0, 0], [1, 1, 1])
    level = np.zeros((4 * 64 - 1) // 3)
    board = {"object_points": BOARD, "size": (40, 30)}
    odds = {"hit": 1.39, "miss": -0.8, "l_min": -2.0, "l_max": 3.48}
    f = {"focal": 500.0, "baseline": 0.4}
    lines = laser.beam_times(LASERS["left"], 2)
    table = {
        camera.Pinhole: {"K": LENS.K, "size": (40, 30), "distortion": np.zeros(5)},
        camera.Pinhole.of_view: {"size": (40, 30), "field_of_view": 1.0},
        camera.Pair: {"left": LENS, "right": LENS, **right},
        camera.calibrate: {**board, "image_points": SHEETS},
        camera.calibrate_pair: {**board, "left_points": SHEETS, "right_points": SHEETS - 0.3},
        camera.chessboard: {"columns": 5, "rows": 4, "square": 0.1},
        camera.cross_matrix: {"t": right["t"]},
        camera.eight_points: left,
        camera.epipolar_lines: {"F": camera.essential_matrix(**right), "pixels": PLANE},
        camera.essential_matrix: right,
        camera.fundamental_matrix: {"left": LENS, "right": LENS, **right},
        camera.pixel_map: {"camera": LENS, "R": np.eye(3), "K": LENS.K},
        camera.rectify: {"pair": PAIR},
        camera.relative_pose: {"E": camera.essential_matrix(np.eye(3), [-0.2, 0, 0]), **left},
        camera.remap: {"image": LEFT, "where": RNG.uniform(0, 20, (7, 2))},
        camera.rotation: {"vector": right["t"]},
        camera.rotation_vector: {"R": camera.rotation([0.1, 0.2, 0.3])},
        camera.triangulate: {**left, "R": np.eye(3), "t": np.array([-0.2, 0.0, 0.0])},
        stereo.block_match: {"left": LEFT, "right": RIGHT, **match, **sure},
        stereo.prefiltered: {
            "image": LEFT, "prefilter": "normalised", "cap": 31, "normalising": 9
        },
        stereo.depth: {"disparity": RNG.uniform(0, 60, (4, 5)), **f},
        stereo.depth_deviation: {"z": RNG.uniform(1, 9, 5), **f, "disparity_deviation": 0.2},
        stereo.point_covariance: {
            "points": np.abs(POINTS) + 1, **f, "disparity_deviation": 0.2, "pixel_deviation": 0.3
        },
        stereo.reproject: {
            "disparity": RNG.uniform(0, 60, (4, 5)), "Q": camera.rectify(PAIR).Q
        },
        rays.HeightField: {"heights": FIELD.heights, "cell": 0.5, "origin": (-2.0, -2.0)},
        rays.Body: {"vertices": POINTS[:4], "faces": np.array([[0, 1, 2], [0, 2, 3]])},
        rays.RayCaster: {
            "fields": [FIELD], "bodies": [CRATE], "poses": np.eye(4)[None], "plain": True,
            "reach": 9.0,
        },
        picture.Paint: {"brightness": 0.5, "contrast": 0.3, "ambient": 0.5},
        picture.Texture: {"levels": level, "pixels": 8, "side": 1.0},
        picture.Texture.of_noise: {"seed": 1, "side": 0.64, "pixels": 16},
        picture.looking: {"eye": np.array([4.0, 0, 3]), "target": np.zeros(3)},
        picture.smooth_noise: {
            "seed": 1, "wavelengths": (0.04, 0.08), "side": 0.64, "pixels": 16
        },
        picture.view: {
            "caster": caster(), "camera": BENT, "T_world_camera": POSE, "paints": [PAINT] * 3,
            "texture": texture(),
        },
        cloud.box: {"low": np.zeros(3), "high": np.ones(3)},
        cloud.hull: {"vertices": POINTS},
        cloud.incidence: {"points": POINTS, "origin": np.zeros(3)},
        cloud.shadow_filter: {
            "points": POINTS, "origin": np.zeros(3), "least": 0.2, "most": 3.0, "neighbours": 1
        },
        cloud.statistical_outliers: {"points": POINTS, "neighbours": 5, "multiplier": 1.0},
        cloud.radius_outliers: {"points": POINTS, "radius": 0.5, "neighbours": 2},
        cloud.self_filter: {
            "points": POINTS, "volumes": {"boom": [box]}, "poses": {"boom": np.eye(4)},
            "padding": 0.05,
        },
        cloud.voxel_grid: {"points": POINTS, "leaf": 0.3},
        octree.OccupancyOctree: {"resolution": 0.1, **odds},
        octree.updated: {"log_odds": np.array([0.3, np.nan]), "reflected": [True, False], **odds},
        octree.looks_until: {
            "log_odds": [0.3, np.nan], "occupied": True, "hit": 1.39, "miss": -0.8
        },
        camera.find_corners: {"image": LEFT, "columns": 4, "rows": 3},
        camera.homography: {"plane": PLANE, "pixels": OTHER},
        picture.chessboard_pictures: {
            "camera": BENT, "poses": SHEET[None], "columns": 4, "rows": 3, "square": 0.1,
            "behind": np.zeros((30, 40), np.uint8), "fine": 2,
        },
        stereo.semi_global_match: {
            "left": LEFT, "right": RIGHT, "disparities": 16, "window": 5, "prefilter": "sobel",
            "cap": 63, "small": 32, "large": 128, "uniqueness": 5, "left_right": 1.0,
            "speckle": 20, "step": 1.0,
        },
        laser.Motion: {"time": motion().time, "q": motion().q, "pose": motion().pose},
        laser.Motion.standing: {"q": np.zeros(4), "pose": np.zeros(3)},
        laser.beam_angles: {"laser": LASERS["left"]},
        laser.beam_times: {"laser": LASERS["left"], "lines": 3, "start": 0.5},
        laser.directions: {"laser": LASERS["left"], "time": lines},
        laser.nod_angles: {"laser": LASERS["left"], "time": lines},
        laser.deskew: {
            "laser": LASERS["left"], "time": lines, "ranges": 5 + lines, "motion": motion(),
            "machine": BACKHOE,
        },
        laser.sensor_poses: {
            "mount": STEREO.mount, "time": [0.1, 0.2], "motion": motion(), "machine": BACKHOE
        },
        distance_field.DistanceField: {
            "occupied": np.zeros((2, 3, 4), bool), "cell": 0.5, "corner": np.zeros(3),
            "signed": False,
        },
        distance_field.DistanceField.of_octree: {
            "tree": tree(), "box": np.array([[-1.0] * 3, [1.0] * 3]), "unknown": "free",
            "signed": False,
        },
        distance_field.distance_transform: {
            "occupied": np.eye(4, dtype=bool)[None], "cell": 0.5, "signed": False
        },
        distance_field.covering_spheres: {
            "vertices": CRATE_MESH[0], "faces": CRATE_MESH[1], "size": 0.5
        },
        distance_field.clearance: {
            "field": field(), "spheres": {"boom": np.array([[1.0, 1, 1, 0.2]])},
            "poses": {"boom": np.eye(4)}, "beyond": None,
        },
        terrain_map.TerrainMap: {
            "corner": (0.0, 0.0), "rows": 4, "columns": 5, "cell": 0.1, "growth": 0.0,
            "roughness": 0.01, "gate": 4.0,
        },
        terrain_map.is_soil: {"points": POINTS, "steepest": 0.6, "tolerance": 0.15, "cell": 0.3},
        terrain_map.surface_levels: {"points": POINTS, "cell": 0.3, "gap": 0.3},
        terrain_map.shared_errors: {
            "heights": np.zeros((5, 6)), "ground": ground(), "origin": np.array([0.0, 0, 3])
        },
        terrain_map.dug_volume: {
            "before": ground(), "after": ground(), "inside": np.eye(5, 6, dtype=bool),
            "origins": np.array([[0.0, 0, 3]] * 2), "common": np.eye(7) * 1e-4,
            "still": np.eye(5, 6, 2, dtype=bool),
        },
        octree.OccupancyOctree.load: {"path": folder / "good.ot", **odds},
    }  # fmt: skip
    found = {function.__qualname__: (function, given) for function, given in table.items()}
    ray = {"start": np.tile([0.0, 0, 5], (3, 1)), "vector": np.array([[0.1, 0, -1.0]] * 3)}
    cast = {"origins": POINTS, "directions": POINTS, "max_range": 3.0, "through_unknown": False}
    methods = [
        (lambda: LENS, "project", {"points": np.abs(POINTS)}),
        (lambda: BENT, "distort", {"plane": PLANE}),
        (lambda: BENT, "undistort", {"pixels": 30 * np.abs(PLANE)}),
        (caster, "pose", {"poses": np.eye(4)[None]}),
        (caster, "cast", {**ray, "most": 9.0}),
        (caster, "covered", {"K": LENS.K, "T": POSE, "width": 40}),
        (
            tree,
            "insert_scan",
            {"points": POINTS, "origin": np.zeros(3), "max_range": 2.0, "rule": "scan"},
        ),
        (tree, "log_odds", {"points": POINTS, "depth": 15, "policy": "mean"}),
        (tree, "leaves", {"depth": 14, "box": np.array([[-1.0] * 3, [1.0] * 3])}),
        (tree, "bounds", {}),
        (tree, "prune", {}),
        (tree, "cast", cast),
        (motion, "at", {"time": [0.3, 0.5]}),
        (motion, "link_poses", {"time": [0.3, 0.5], "machine": BACKHOE}),
        (field, "query", {"points": np.abs(PLANE[:, [0, 1, 0]]), "beyond": None}),
        (ground, "age", {"now": 3.0}),
        (ground, "grid", {}),
        (
            ground,
            "insert",
            {
                "points": POINTS,
                "origin": np.array([0.0, 0, 3]),
                "time": 1.0,
                "range_deviation": 0.02,
                "common_deviation": 0.0,
            },
        ),
        (tree, "save", {"path": folder / "new.ot"}),
    ]
    for make, name, given in methods:
        found[f"{type(make()).__name__}.{name}"] = method(make, name), given
    return found


NAMES = public(
    [
        importlib.import_module(f"backhoe.perception.{module.name}")
        for module in pkgutil.iter_modules(backhoe.perception.__path__)
    ],
    RESULTS,
)


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    return calls(tmp_path_factory.mktemp("fuzz"))


def test_every_public_function_is_called_with_all_its_arguments(table):
    assert_complete(table, NAMES)


SAID = {
    "bodies": ("body",),
    "path": ("file", "good.ot"),
    "volumes": ("volume",),
    "poses": ("pose",),
    "pair": ("right camera",),
    "left": ("pictures", "points"),
    "right": ("pictures", "points"),
}
"""Words that stand for an argument in an error."""

SLOW = ("calibrate", "calibrate_pair")
"""Too slow to try each value, and pairs of arguments."""


@pytest.mark.parametrize("name", sorted(NAMES))
@pytest.mark.timeout(300)
def test_wrong_input_is_answered_or_refused_by_name(table, name):
    assert_answers_or_names(*table[name], SAID, len(name), name in SLOW)


@pytest.mark.parametrize("ending", [".ot", ".bt"])
def test_files_of_chance_are_maps_or_are_refused(ending, tmp_path):
    path, rng = tmp_path / f"map{ending}", np.random.default_rng(5)
    tree().save(path)
    content = path.read_bytes()
    start = content.index(b"data\n") + 5
    with little_memory():
        for trial in range(200):
            wrong = bytearray(content)
            for _ in range(rng.integers(1, 6)):
                at = rng.integers(start if trial % 2 else 0, len(wrong))
                wrong[at : at + rng.integers(0, 4)] = rng.bytes(rng.integers(0, 4))
            if trial % 5 == 0:
                size = int(rng.integers(0, 10**12))
                wrong = re.sub(rb"size \d+", b"size %d" % size, bytes(wrong))
            path.write_bytes(wrong)
            try:
                made = octree.OccupancyOctree.load(path)
            except ValueError as error:
                assert re.search("must|damaged|claims|more than", str(error)), error
            else:
                assert np.isfinite(made.leaves().log_odds).all()
