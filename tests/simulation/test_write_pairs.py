"""The recorded pair is what its command makes, and its truth is that of the scene."""

import numpy as np
import pytest

from backhoe import simulation
from backhoe.arm.kinematics import inverse_kinematics
from backhoe.perception.picture import looking
from backhoe.simulation import write_pairs
from backhoe.simulation.sight import Sight


@pytest.fixture(scope="module")
def stored():
    return dict(np.load(write_pairs.FOLDER / "loading.npz"))


def test_the_command_makes_the_stored_pair_again(stored, tmp_path):
    assert write_pairs.main(["--folder", str(tmp_path)]) == 0
    made = np.load(tmp_path / "loading.npz")
    assert set(made) == set(stored)
    for name in ("left", "right"):
        assert np.abs(made[name].astype(int) - stored[name]).max() <= 1
    differ = np.abs(made["disparity"].astype(int) - stored["disparity"]) > 1
    assert differ.mean() < 1e-5 and (made["surface"] != stored["surface"]).mean() < 1e-5
    assert made["focal"] == stored["focal"] and made["baseline"] == stored["baseline"]


def test_it_shows_truck_heap_and_bucket_and_is_small(stored):
    seen = {name: (stored["surface"] == k).mean() for k, name in enumerate(stored["names"])}
    assert min(seen["truck"], seen["terrain"], seen["bucket"]) > 0.05
    assert (write_pairs.FOLDER / "loading.npz").stat().st_size < 1e6


def test_its_true_disparity_is_that_of_a_ray_from_the_other_eye(stored):
    """A point at the true depth projects into the right eye where the disparity says, to 1/256."""
    T = looking(write_pairs.EYE, write_pairs.TARGET)
    other = T.copy()
    other[:3, 3] += float(stored["baseline"]) * T[:3, 0]
    rng = np.random.default_rng(0)
    rows, columns = rng.integers(0, 480, 300), rng.integers(0, 640, 300)
    K = write_pairs.CAMERA.K
    plane = np.c_[(columns - K[0, 2]) / K[0, 0], (rows - K[1, 2]) / K[1, 1], np.ones(300)]
    with simulation.open_world(backend="analytic") as world:
        world.reset(q=tuple(inverse_kinematics(write_pairs.TIP)), pose=write_pairs.BASE)
        points = Sight(world).cast(np.tile(T[:3, 3], (300, 1)), plane @ T[:3, :3].T).points
    hit = np.isfinite(points[:, 0])
    across = (points[hit] - other[:3, 3]) @ other[:3, :3]
    apart = columns[hit] - (K[0, 0] * across[:, 0] / across[:, 2] + K[0, 2])
    np.testing.assert_allclose(
        stored["disparity"][rows, columns][hit] / write_pairs.STEPS, apart, atol=0.51 / 256
    )
