"""Soil on the way: led as simulated, least of what is held, and ways that spill nothing."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from backhoe import simulation
from backhoe.arm.kinematics import forward_kinematics, inverse_kinematics
from backhoe.arm.movement import from_postures
from backhoe.machine import BACKHOE
from backhoe.mission import hauling, smooth_trajectory
from backhoe.mission.parts import hand_made_plan
from backhoe.planning.search import pitch, rrt_connect
from backhoe.simulation.scene import LOADING
from backhoe.simulation.soil import soil_of
from backhoe.simulation.soil.bucket_fill import BucketFill
from backhoe.view.appearance import truck_boxes, visuals


def loaded(x, y, z, psi=-3.0):
    q = inverse_kinematics((x, y, z, 0.0))
    q[3] = psi - pitch(q)
    return q


START, GOAL = loaded(6.2, 0.0, 3.4), loaded(0.4, 5.6, 3.85)


def tilted(degrees, seconds):
    """A swing halfway to the truck on which the bucket tilts and comes back."""
    q = np.linspace(START, START + 0.4 * (GOAL - START), 5)
    q[2, 3] += np.radians(degrees)
    return from_postures(np.linspace(0, seconds, 5), q, dt=0.01)


@pytest.mark.parametrize("degrees", [25, 70])
@pytest.mark.parametrize("name", ["sandy loam", "dry sand"])
def test_a_slow_way_keeps_the_least_of_what_the_bucket_holds_along_it(degrees, name):
    soil = soil_of(name)
    moved = tilted(degrees, 12.0)
    carried = hauling.carry(moved.t, moved.q, soil=soil)
    fill = BucketFill(BACKHOE.shell, soil.repose)
    held = [fill.retained(angle) for angle in pitch(moved.q)]
    assert carried.kept[0] == pytest.approx(held[0])
    assert carried.kept[-1] == pytest.approx(min(held), abs=0.02)
    assert carried.loaded == 0.0
    assert carried.spilled == pytest.approx(held[0] - carried.kept[-1], abs=1e-9)


def test_what_falls_over_the_truck_is_loaded():
    q = np.linspace(GOAL, GOAL, 4)
    q[2:, 3] += 1.9
    moved = from_postures([0, 1, 4, 5], q, dt=0.01)
    carried = hauling.carry(moved.t, moved.q)
    assert carried.loaded > 0.7 and carried.spilled < 0.02 and carried.kept[-1] < 0.01
    beside = hauling.carry(moved.t, moved.q, scene=replace(LOADING, truck=None))
    assert beside.loaded == 0.0 and beside.spilled == pytest.approx(carried.loaded, abs=0.02)


def test_the_led_bucket_spills_what_the_simulated_one_does():
    """Torques of the controller at 1 kHz, the analytic backend."""
    from backhoe.arm import dynamics, pid

    moved = tilted(50, 4.0)
    led = hauling.carry(moved.t, moved.q, 0.7)
    with simulation.open_world(backend="analytic", soil=True) as world:
        world.reset(moved.q[0])
        world.ground.bucket_volume = 0.7
        control = pid.PID(*pid.ARM_GAINS, BACKHOE.torque_limit)
        for k in range(10 * (len(moved.t) - 1)):
            q_ref, dq_ref = moved.q[k // 10], moved.dq[k // 10]
            torque = control(q_ref, dq_ref, world.q, world.dq, world.dt)
            world.step(torque + dynamics.gravity_torque(world.q))
        kept = world.ground.bucket_volume
    assert led.kept[-1] == pytest.approx(kept, abs=0.03) and led.kept[-1] < 0.45


@pytest.mark.parametrize("seed", range(3))
def test_a_level_way_is_free_and_spills_nothing_where_a_search_alone_spills(seed):
    truck = replace(LOADING.truck, x=1.5, y=5.2, floor=1.25, wall=2.05)
    scene = replace(LOADING, truck=truck)
    world, exact = hauling.arm_world(scene, margin=0.15), hauling.arm_world(scene, fine=True)
    start, goal = loaded(5.88, 1.16, 2.5), loaded(1.1, 5.5, 3.85)
    ways = {
        "level": hauling.level_way(start, goal, world, seed=seed),
        "free": rrt_connect(
            start, goal, world.is_free, world.lower, world.upper, seed=seed, resolution=0.05
        ),
    }
    spilled = {}
    for name, way in ways.items():
        assert_allclose(way[[0, -1]], [start, goal], atol=1e-9)
        moved = hauling.in_time(way, BACKHOE.speed_limit, BACKHOE.speed_limit, piece=0.2)
        assert exact.clearance(moved.q[::10]).min() > 0
        spilled[name] = hauling.carry(moved.times, moved.q, scene=scene).spilled
    assert spilled["level"] < 1e-6 and spilled["free"] > 0.05
    assert exact.clearance(np.linspace(start, goal, 40)).min() < 0


def test_a_planned_swing_keeps_its_margin_where_the_hand_made_one_does_not():
    scene = replace(LOADING, truck=replace(LOADING.truck, x=1.4, y=5.1, floor=1.35, wall=2.05))
    exact = hauling.arm_world(scene, fine=True)
    least = []
    for plan in (hand_made_plan, hauling.planned_swing(scene=scene)):
        points = plan(0)
        times = np.cumsum([0.0, *(point.time for point in points)])[1:]
        q = np.array([inverse_kinematics(point.target) for point in points])
        t = np.arange(times[4], times[-3], 0.1)
        angles, speeds = smooth_trajectory(times, q, t)
        assert (np.abs(speeds) < 0.6 * BACKHOE.speed_limit).all()
        least.append(exact.clearance(angles).min())
    assert least[0] < 0.25 and least[1] >= 0.4


def test_a_planned_swing_at_less_pace_takes_longer():
    lasts = [
        sum(point.time for point in hauling.planned_swing(pace=pace)(0)[5:-2])
        for pace in (0.25, 0.75)
    ]
    assert lasts[0] > 1.3 * lasts[1]


def test_a_wrong_way_is_no_plan():
    start, goal = (inverse_kinematics(point.target) for point in hand_made_plan(0)[4:6])
    plan = hauling.planned_swing(lambda start, goal, world: np.array([start, start]))
    with pytest.raises(ValueError, match="end at goal"):
        plan(0)
    with pytest.raises(ValueError, match="way"):
        hauling.planned_swing(lambda start, goal, world: [start[:3], goal[:3]])(0)
    with pytest.raises(ValueError, match="pace"):
        hauling.planned_swing(pace=2.0)
    with pytest.raises(TypeError, match="way"):
        hauling.planned_swing("level")
    world = hauling.arm_world()
    with pytest.raises(ValueError, match="start"):
        hauling.level_way(start - [0, 1.0, 0, 0], goal, world)
    with pytest.raises(ValueError, match="heights"):
        hauling.arm_world(heights=np.zeros((2, 2)))
    with pytest.raises(ValueError, match="volume"):
        hauling.carry([0, 1], [start, start], 2.0)
    with pytest.raises(ValueError, match="joints"):
        hauling.carry([0, 1], [start[:3], start[:3]])


def test_a_run_is_measured_from_its_log():
    """A made-up run: a stop above the cab, and soil that leaves the bucket high and low."""
    high, low = GOAL, inverse_kinematics((5.8, 0.0, 1.5, 1.2))
    q = np.array([low, low, START, START, high, high])
    run = object.__new__(hauling.Run)
    log = {
        "scene": LOADING,
        "machine": BACKHOE,
        "q": q,
        "time": np.arange(6.0),
        "bucket_volume": np.array([0.7, 0.6, 0.6, 0.5, 0.5, 0.2]),
        "truck_volume": np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.3]),
    }
    for name, value in log.items():
        object.__setattr__(run, name, value)
    haul = hauling.hauled(run, every=1)
    assert haul.spilled == pytest.approx(0.1)
    own = np.concatenate([part.vertices for part in visuals()["bucket"]])
    T = forward_kinematics(high)
    corners = own @ T[:3, :3].T + T[:3, 3]
    gaps = [np.clip(corners, *box) - corners for box in truck_boxes(LOADING.truck)]
    nearest = min(np.linalg.norm(gap, axis=1).min() for gap in gaps)
    assert nearest - 0.35 < haul.clearance <= nearest
    assert haul.time == 4.0 and "spilled on the way 100 l" in str(haul)
    with pytest.raises(ValueError, match="every"):
        hauling.hauled(run, every=0)
    with pytest.raises(TypeError, match="run"):
        hauling.hauled(SimpleNamespace())
