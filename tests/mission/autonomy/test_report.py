"""What a report adds up, on runs that are made up; distances against boxes by another way."""

from types import SimpleNamespace

import numpy as np
import pytest

from backhoe.arm.kinematics import link_transforms
from backhoe.machine import BACKHOE, JOINTS
from backhoe.mission import autonomy
from backhoe.mission.autonomy.report import OPERATORS, clearance, report
from backhoe.simulation.scene import LOADING
from backhoe.simulation.soil import SANDY_LOAM
from backhoe.simulation.soil.bucket_fill import BucketFill
from backhoe.simulation.standing import Least
from backhoe.view.appearance import truck_boxes, visuals

REST = np.radians([-90.0, 30.0, -30.0, 0.0])


def made_up(**changed):
    load = autonomy.Load(10.0, 22.0, 32.0, None, 0.6, 0.6, 0.57, 1)
    after = load._replace(begin=40.0, lifted=54.0, end=62.0, dug=0.4, loaded=0.4)
    n = 101
    run = dict(
        loads=(load, after),
        truck=np.array([0.5, 1.47]),
        power=np.full(n, 36e3),
        views=(
            SimpleNamespace(belief=np.array([3.0, 4.0, 0.1]), pose=np.array([0.0, 0.0, 0.0])),
            SimpleNamespace(belief=np.array([1.0, 0.0, 0.1]), pose=np.array([0.0, 0.0, 0.0])),
        ),
        q=np.tile(REST, (n, 1)),
        pose=np.zeros((n, 3)),
        scene=LOADING,
        machine=BACKHOE,
        soil=SANDY_LOAM,
        least=Least(0.4, 7.0, "front"),
        events=((1.0, "a"), (2.0, "b")),
        stopped=True,
        ended="the truck has left",
        swapped=(),
    )
    return SimpleNamespace(**(run | changed))


def test_times_volumes_and_rates_are_those_of_the_loads():
    found = report(made_up())
    assert found.loads == 2
    assert (found.digging, found.loading, found.cycle) == pytest.approx((13.0, 9.0, 30.0))
    assert found.soil == pytest.approx(0.97)
    assert found.into_truck == pytest.approx(0.97)
    assert found.rate == pytest.approx(0.97 / 52 * 3600)
    assert (found.replans, found.stops, found.margin, found.margin_time) == (2, 1, 0.4, 7.0)
    assert found.astray == pytest.approx(5.0)
    heaped = BucketFill(BACKHOE.shell, SANDY_LOAM.repose).heaped
    assert found.fill == pytest.approx(0.5 / heaped)


def test_energy_in_kilowatt_hours_and_litres():
    found = report(made_up())
    assert found.energy == pytest.approx(36e3 * 101 * 0.02 / 3.6e6)
    assert found.litres == pytest.approx(found.energy * 3.6 / (35.86 * 0.4 * 0.38), rel=2e-3)


def test_a_run_without_a_load_has_no_times():
    found = report(made_up(loads=(), views=()))
    assert found.loads == 0 and np.isnan([found.rate, found.cycle, found.fill]).all()
    assert found.astray == 0.0
    assert "nan" in str(found)


def test_the_text_has_the_operators_beside_and_how_it_ended():
    text = str(report(made_up()))
    assert "digging (12 s) [s]" in text and "loading (10 s) [s]" in text
    assert OPERATORS == (12.0, 10.0)
    assert "ended: the truck has left" in text


def test_the_clearance_is_that_of_the_meshes_or_a_little_less():
    """Against a dense sample of the meshes' points, in the world, with the machine turned."""
    rng = np.random.default_rng(3)
    low, high = BACKHOE.lower, BACKHOE.upper
    q = rng.uniform(low, high, (12, 4))
    q[:, 0] = rng.uniform(-0.6, 0.6, 12)
    pose = np.c_[rng.uniform(-0.5, 0.5, (12, 2)), rng.uniform(-0.3, 0.3, 12)]
    found, drawn = clearance(q, pose, LOADING, BACKHOE), visuals(BACKHOE)
    for k in range(len(q)):
        c, s = np.cos(pose[k, 2]), np.sin(pose[k, 2])
        T = np.array([[c, -s, 0, pose[k, 0]], [s, c, 0, pose[k, 1]], [0, 0, 1, 0], [0, 0, 0, 1]])
        points = []
        for number, link in enumerate(JOINTS[1:], start=1):
            frame = T @ link_transforms(q[k])[number]
            for part in drawn[link]:
                corners = part.vertices[part.faces]
                weights = rng.dirichlet([0.6] * 3, (len(corners), 60))
                inside = np.einsum("fnw,fwi->fni", weights, corners).reshape(-1, 3)
                points.append(np.vstack([part.vertices, inside]) @ frame[:3, :3].T + frame[:3, 3])
        points = np.concatenate(points)
        gaps = [
            np.linalg.norm(points - np.clip(points, low, high), axis=1).min()
            for low, high in truck_boxes(LOADING.truck)
        ]
        assert min(gaps) - 0.26 < found[k] <= min(gaps) + 1e-9
