"""The machine alone, on a short job: what it believes against what is true, and its safe stops."""

from dataclasses import replace

import numpy as np
import pytest

from backhoe import mission
from backhoe.arm import dynamics, pid
from backhoe.machine import BACKHOE
from backhoe.mission import autonomy
from backhoe.mission.autonomy import faults
from backhoe.mission.autonomy.body import Doubt, Holding, Sensors
from backhoe.mission.autonomy.eyes import filled
from backhoe.mission.autonomy.ways import around, carrying, dense, moved, world_seen
from backhoe.planning.search import pitch
from backhoe.simulation.scene import LOADING
from backhoe.simulation.soil import Terrain

NEAR = (-1.2, -0.3, 0.1)
"""A start from which the way is short."""


@pytest.fixture(scope="module")
def short():
    return autonomy.run(loads=1, start=NEAR, seed=3, backend="analytic")


def test_one_bucket_comes_into_the_truck_without_a_touch(short):
    assert (short.ended, short.stopped, len(short.loads)) == ("all buckets are loaded", False, 1)
    (load,) = short.loads
    found = mission.score(short)
    assert load.dug > 0.5 and load.loaded > 0.9 * load.dug
    assert abs(load.weighed - load.dug) < 0.03
    assert found.clearance > 0.1 and found.margin > 0.1
    assert abs(short.soil_lost) < 1e-9
    assert found.soil == pytest.approx(load.loaded, abs=1e-3)
    assert load.begin < load.lifted < load.end < short.time[-1]


def test_a_run_with_a_part_of_yours_is_scored_beside_the_library_s_on_the_same_site(short):
    """The usual mistake, to dig where it is highest, shows in the soil and in the soil an hour."""
    found = mission.score(
        autonomy.run(
            dig_choice=autonomy.highest_strip, loads=1, start=NEAR, seed=3, backend="analytic"
        )
    )
    assert found.swapped == ("dig_choice",) and "swapped in: dig_choice" in str(found)
    assert found.reference == replace(mission.score(short), cycle=found.reference.cycle)
    assert found.soil < 0.8 * found.reference.soil
    assert found.rate < 0.8 * found.reference.rate
    lines = str(found).splitlines()
    for name, decimals in (("soil in the truck [m^3]", 1), ("  a hour [m^3/h]", 0)):
        (line,) = (one for one in lines if one.startswith(name))
        one = "soil" if decimals else "rate"
        printed = [f"{getattr(of, one):.{decimals}f}" for of in (found, found.reference)]
        assert line.split()[-2:] == printed and printed[0] != printed[1]


def test_the_truck_is_found_where_it_stands_seen_from_the_machine(short):
    for view in short.views:
        seen = _from_machine(np.array(view.truck[:2]), view.belief)
        true = _from_machine(np.array([short.scene.truck.x, short.scene.truck.y]), view.pose)
        np.testing.assert_allclose(seen, true, atol=0.08)


def test_the_map_agrees_with_the_ground_where_the_machine_knows_its_place(short):
    view = short.views[0]
    rows, columns = np.nonzero(np.isfinite(view.heights[0]))
    x, y = -9 + 0.1 * columns, -9 + 0.1 * rows
    c, s = np.cos(view.belief[2]), np.sin(view.belief[2])
    dx, dy = x - view.belief[0], y - view.belief[1]
    ahead, left = dx * c + dy * s, dy * c - dx * s
    c, s = np.cos(view.pose[2]), np.sin(view.pose[2])
    true = np.c_[view.pose[0] + ahead * c - left * s, view.pose[1] + ahead * s + left * c]
    near = (np.abs(true - [4.0, 0.0]) < 3.0).all(axis=1)
    ground = Terrain(view.heights[1], short.scene.cell, short.scene.corner)
    off = view.heights[0][rows, columns][near] - ground.height_at(true[near])
    assert near.sum() > 300 and np.percentile(np.abs(off), 95) < 0.08


def test_belief_and_truth_part_by_less_than_the_fixes_allow(short):
    assert np.hypot(*(short.belief - short.pose)[:, :2].T).max() < 0.3
    assert mission.score(short).astray > 0.0


def test_a_lost_look_is_repeated_and_three_stop_the_machine():
    fault = faults.LostScan(first=0, count=9)
    run = autonomy.run(loads=1, start=NEAR, fault=fault, backend="analytic")
    assert run.stopped and "3 looks after another were lost" in run.ended and not run.views
    assert (np.abs(run.dq[-1]) < 0.05).all()


def test_a_truck_out_of_reach_stops_the_machine_before_it_digs():
    run = autonomy.run(
        loads=1, start=NEAR, fault=faults.TruckElsewhere(by=(-0.5, 2.5)), backend="analytic"
    )
    assert run.stopped and "tipping out needs" in run.ended
    assert run.truck[-1] == 0.0


def test_a_heap_too_near_stops_it():
    fault = faults.HeapElsewhere(by=(-3.2, 0.0))
    run = autonomy.run(loads=1, start=NEAR, fault=fault, backend="analytic")
    assert run.stopped and "too near" in run.ended


def test_a_reversed_gyro_is_found_out_by_a_little_turn():
    start = (-4.0, -1.2, 0.3)
    run = autonomy.run(loads=1, start=start, fault="gyro reversed", backend="analytic")
    assert run.stopped and "reversed" in run.ended and run.time[-1] < 12.0
    assert any("gyro" in what for _, what in run.events)


def test_gyro_and_tracks_may_differ_by_the_slip_but_no_more():
    class Plant:
        machine, dt, time, pose = BACKHOE, 0.02, 0.0, np.zeros(3)
        belts, twist = np.array([0.2, 0.6]), np.array([0.4, 0.0])

    plant = Plant()
    gauge = BACKHOE.tracks.gauge
    plant.twist = np.array([0.4, 0.75 * 0.4 / gauge])
    sensors = Sensors(plant, {"odometry": "library"}, None, 0)
    sensors.watch(faults.Fault())
    for _ in range(60):
        sensors.sense()
        sensors.check()
    assert sensors.same_way()
    plant.twist = -plant.twist
    with pytest.raises(Doubt, match="gyro"):
        for _ in range(30):
            sensors.sense()
            sensors.check()


def test_the_compiled_controller_is_chapter_three_s():
    rng = np.random.default_rng(1)
    compiled, plain = Holding(BACKHOE, 0.001), pid.PID(*pid.ARM_GAINS, BACKHOE.torque_limit)
    for _ in range(200):
        q_ref, dq_ref, q, dq = rng.normal(size=(4, 4)) * 0.2
        wanted = plain(q_ref, dq_ref, q, dq, 0.001) + dynamics.gravity_torque(q)
        np.testing.assert_allclose(compiled(q_ref, dq_ref, q, dq), wanted, rtol=1e-9, atol=1e-6)


def test_a_way_to_the_truck_keeps_off_it_and_stays_level():
    class Map:
        heights = np.full((190, 210), np.nan)

    belief = np.array([0.0, 0.0, 0.05])
    world = world_seen(LOADING.truck, Map, belief, 0.2, BACKHOE)
    start, goal = (np.array([swing, 0.48, -0.02, 0.0]) for swing in (-1.6, -0.05))
    start[3], goal[3] = carrying(start), carrying(goal)
    path = around(start, goal, world.is_free)
    assert world.is_free(dense(path)).all()
    np.testing.assert_allclose(pitch(path), pitch(start), atol=1e-9)
    times, q = moved(path)
    assert (np.abs(np.gradient(q, times, axis=0)) < BACKHOE.speed_limit).all()
    np.testing.assert_allclose(q[[0, -1]], [start, goal], atol=1e-9)


def test_a_bucket_at_the_end_of_its_joint_is_planned_for_nevertheless():
    start, goal = np.array([-1.6, 0.48, -0.02, 0.0]), np.array([0.42, 0.476, 0.356, 0.0])
    start[3], goal[3] = carrying(start), carrying(goal)
    assert goal[3] == BACKHOE.lower[3]
    wall = 0.9  # over which no simple way goes

    def is_free(q):
        within = ((q >= BACKHOE.lower) & (q <= BACKHOE.upper)).all(axis=-1)
        return within & ((np.abs(q[..., 0] + 0.6) > 0.1) | (q[..., 1] > wall))

    path = around(start, goal, is_free)
    assert is_free(dense(path)).all()
    np.testing.assert_allclose(path[[0, -1]], [start, goal], atol=1e-6)


def test_gaps_between_the_lines_are_filled_from_their_neighbours_only():
    plane = 0.1 * np.arange(40)[:, None] + 0.05 * np.arange(60)
    seen = plane.copy()
    seen[::2] = np.nan
    seen[:, 45:] = np.nan
    full = filled(seen)
    np.testing.assert_allclose(full[6:-6, 6:39], plane[6:-6, 6:39], atol=0.02)
    assert np.isnan(full[:, 52:]).all() and np.isfinite(full[:, :45]).all()


def test_the_site_of_a_seed_is_near_the_order_and_seed_nought_is_the_order():
    assert autonomy.site(0) == LOADING
    for seed in range(1, 20):
        site = autonomy.site(seed)
        assert abs(site.heaps[0].x - LOADING.heaps[0].x) <= 0.3
        assert abs(site.truck.y - LOADING.truck.y) <= 0.2
    assert autonomy.site(1) != autonomy.site(2)


def test_bad_input_is_named():
    with pytest.raises(ValueError, match="fault"):
        autonomy.run(fault="rain")
    with pytest.raises(TypeError, match="unknown part 'plan'"):
        autonomy.run(plan=print)
    with pytest.raises(ValueError, match="a heap and a truck"):
        autonomy.run(scene=mission.autonomy.running.simulation.scene.FLAT)
    with pytest.raises(ValueError, match="loads"):
        autonomy.run(loads=0)
    with pytest.raises(ValueError, match="start"):
        autonomy.run(start=(0.0, 0.0))
    with pytest.raises(ValueError, match="your terrain failed: no room"):
        autonomy.run(terrain=_no_room, start=NEAR, backend="analytic")


def _no_room(corner, rows, columns, cell):
    raise ValueError("no room")


def _from_machine(point, pose):
    c, s = np.cos(pose[2]), np.sin(pose[2])
    d = point - pose[:2]
    return np.array([d[0] * c + d[1] * s, d[1] * c - d[0] * s])
