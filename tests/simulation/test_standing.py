"""Both simulations know at every step how far the machine is from tipping, and stop in time."""

from dataclasses import replace

import numpy as np
import pytest

from backhoe import mission, simulation
from backhoe.arm import dynamics, kinematics
from backhoe.machine import BACKHOE
from backhoe.machine.variants import loaded
from backhoe.simulation import engine, standing
from backhoe.whole_body import stability

STIFF = np.array([1.2e6, 1.5e6, 4e5, 1.2e5]), np.array([4e5, 3e5, 6e4, 1.5e4])
LIGHT = replace(BACKHOE, tracks=replace(BACKHOE.tracks, mass=1500.0, gauge=1.8, length=2.6))
OUT = np.radians([-90.0, 0.0, 40.0, 20.0])


@pytest.fixture(params=["pybullet", "analytic"])
def backend(request):
    if request.param == "pybullet":
        pytest.importorskip("pybullet")
    return request.param


def hold(world, q, push=0.0):
    """One step with the arm held at q [rad], and some torque more [N m]."""
    kp, kd = STIFF
    gravity = dynamics.gravity_torque(world.q, world.machine)
    world.step(kp * (q - world.q) - kd * world.dq + gravity + push)


def in_vehicle(vector, yaw):
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([vector[0] * c + vector[1] * s, vector[1] * c - vector[0] * s])


def test_every_step_has_the_margin_of_its_motion(backend):
    """Coordinates, rates and the soil's force, given to `stability.margin` one by one."""
    wild = np.random.default_rng(4)
    with simulation.open_world(backend=backend, seed=3) as world:
        seen = np.inf
        for k in range(1500):
            q, dq, pose, twist = world.q, world.dq, world.pose, world.twist
            load = world.ground.payload
            force, moment = world.soil_force, world.ground.moment
            belts = (0.6, -0.2) if k > 700 else (0.0, 0.0)
            push = 3e4 * np.sin(0.01 * k * np.arange(1, 5)) + 5e3 * wild.normal(size=4)
            world.step(dynamics.gravity_torque(q) - 1e4 * dq + push, belts)
            changed = (world.twist - twist) / world.dt
            found = stability.margin(
                q,
                dq,
                (world.dq - dq) / world.dt,
                load=load,
                yaw_rate=twist[2],
                acceleration=[*in_vehicle(changed, pose[2]), changed[2]],
                soil=[*in_vehicle(force, pose[2]), force[2], moment],
            )
            assert world.margin == pytest.approx(found.distance, abs=1e-6)
            assert world.edge == found.edge
            seen = min(seen, found.distance)
        assert world.least_margin.margin == pytest.approx(seen, abs=2e-6)


def test_both_backends_see_one_margin():
    pytest.importorskip("pybullet")
    runs = [mission.run(cycles=1, backend=name) for name in ("pybullet", "analytic")]
    assert runs[0].margin == pytest.approx(runs[1].margin, abs=1e-4)
    assert runs[0].least.margin == pytest.approx(runs[1].least.margin, abs=1e-5)
    assert runs[0].least.time == pytest.approx(runs[1].least.time, abs=2e-3)
    assert runs[0].least.edge == runs[1].least.edge == "front"


def test_it_repeats_bit_for_bit_and_comes_back_with_a_snapshot(backend):
    def log(world, count):
        rows = []
        for k in range(count):
            hold(world, OUT, 4e4 * np.sin(0.02 * k))
            rows.append([world.margin, *world.zero_moment_point, *world.least_margin[:2]])
        return np.array(rows)

    with simulation.open_world(backend=backend, q=OUT) as world:
        first = log(world, 300)
        world.reset()
        assert np.array_equal(log(world, 300), first)
        kept = world.snapshot()
        after = log(world, 200)
        world.restore(kept)
        assert world.margin == first[-1, 0]
        assert np.array_equal(log(world, 200), after)


def test_the_compiled_balance_is_the_plain_one():
    wild = np.random.default_rng(1)
    masses = standing.masses_of(BACKHOE)
    masses[-1] += 900.0
    for _ in range(50):
        memory = np.zeros(standing.MEMORY)
        memory[:20] = wild.normal(size=20) * np.r_[np.ones(14), np.full(6, 1e3)]
        memory[25] = np.inf
        memory[29:] = 1e-3 * np.abs(wild.normal(size=8))
        state, soil = memory[:14] + 1e-3 * wild.normal(size=14), 1e4 * wild.normal(size=4)
        both = memory.copy(), memory.copy()
        edges = [
            stand(masses, state, soil, copy, 7, 0.001)
            for stand, copy in zip((standing.stand, engine.stand), both, strict=True)
        ]
        assert edges[0] == edges[1]
        assert both[0] == pytest.approx(both[1], rel=1e-12, abs=1e-12, nan_ok=True)


@pytest.mark.parametrize(("share", "tips"), [(0.95, False), (1.05, True)])
def test_an_overloaded_machine_stops_and_says_when_over_which_edge(backend, share, tips):
    q = np.radians([0.0, 0.0, 40.0, 20.0])
    load, edge = stability.tipping_load(q)
    heavy = loaded(share * load)
    flat = {"backend": backend, "scene": simulation.FLAT, "soil": False, "q": q}
    with simulation.open_world(heavy, **flat) as world:
        try:
            for _ in range(2500):
                hold(world, q)
            assert not tips
            assert 0.0 < world.least_margin.margin < 0.1
        except simulation.Tipped as error:
            assert tips
            assert "over its left edge" in str(error)
            assert "lies here even at rest and empty" in str(error)
            assert error.edge == edge == "left"
            assert 0.2 < error.time < 2.0
            assert isinstance(error, RuntimeError)
            world.reset()
            hold(world, q)


def test_a_fixed_base_holds_what_would_tip(backend):
    with simulation.open_world(LIGHT, backend=backend, q=OUT, soil=False, base="fixed") as world:
        for _ in range(1500):
            hold(world, OUT)
        assert world.margin < -0.05


def test_a_hasty_mission_tips_on_what_the_soil_holds_and_the_message_says_so():
    def hasty(cycle):
        """The plan of lesson 00's last exercise at six tenths of the joints' speed, in loam."""
        points = mission.hand_made_plan(cycle)
        q = kinematics.inverse_kinematics([point.target for point in points])
        times = (np.abs(np.diff(q, axis=0)) / (0.6 * BACKHOE.speed_limit)).max(axis=1)
        times = [points[0].time, *np.maximum(times, 0.5)]
        return [replace(point, time=t) for point, t in zip(points, times, strict=True)]

    said = r"over its front edge at t = \d+\.\d+ s with \d+ kg.*soil held the bucket with \d+ kN"
    with pytest.raises(simulation.Tipped, match=said) as caught:
        mission.run(plan=hasty, cycles=1, backend="analytic", soil="loam", record=True)
    (note,) = caught.value.__notes__
    assert note.startswith("This happened on the way to 'curl'.")
    run = caught.value.run
    assert 0 <= caught.value.time - run.time[-1] < 0.011
    assert len(run.q) == len(run.q_ref) == len(run.margin) == len(run.time)
    assert run.least.margin == pytest.approx(run.margin.min(), abs=0.02)
    reached = ~np.isnan(run.reached).any(axis=1)
    names = [point.name for point, there in zip(run.waypoints, reached, strict=True) if there]
    assert names == ["turn to the heap", "cut in", "pull"]
    assert "Dig and load" in run.replay()._repr_html_()


def test_a_stop_that_lifts_a_track_a_little_is_no_tipping():
    """As in PyBullet with a free base: the force leaves the polygon, the machine falls back."""
    pytest.importorskip("pybullet")
    from free_machine import DT, FreeMachine

    q = np.radians([-60.0, 15.0, 10.0, 0.0])
    for load, most in ((3000.0, 3e5), (1500.0, 1e6)):
        masses = standing.masses_of(BACKHOE)
        masses[-1] += load
        memory = np.zeros(standing.MEMORY)
        memory[25] = np.inf
        lifted, tilts, edge = 0.0, [], -1
        with FreeMachine(q, load) as free:
            free.step(300)
            angles, rates = free.state()
            memory[:14] = np.r_[np.zeros(3), angles, np.zeros(3), rates]
            for k in range(2000):
                speed = 0.6 if 200 < k < 1200 else 0.0
                free.turn([speed, 0, 0, 0], [most, 1e8, 1e8, 1e8])
                free.step()
                state = free.coordinates()
                edge = max(edge, engine.stand(masses, state, np.zeros(4), memory, k, DT))
                lifted = max(lifted, free.tilt)
                tilts.append(standing.balance_in(memory).tilt.max())
        assert standing.balance_in(memory).least[0] < -0.05
        assert edge == -1
        assert max(tilts) == pytest.approx(lifted, rel=0.1)


def felt_at_the_yaw_joint(world):
    """PyBullet's own reaction at a joint under a machine at rest: where (2,) [m], how much [N]."""
    server, joint = world._server, world._joint["base_yaw"]
    server.enableJointForceTorqueSensor(world._body, joint, 1)
    world.step(dynamics.gravity_torque(world.q) + np.array([0.0, -6e4, 0.0, 0.0]))
    _, _, force, mx, my, _ = server.getJointState(world._body, joint)[2]
    return np.array([-my, mx]) / force, force


def test_the_truck_carries_what_leans_on_it():
    """A bucket set down on the truck's wall takes weight off the tracks, at its own place."""
    pytest.importorskip("pybullet")
    truck = simulation.LOADING.truck
    wall = truck.y - truck.bed_width / 2
    target = [truck.x, wall - 0.2, truck.wall + 1.75, np.radians(10.0)]
    q = kinematics.inverse_kinematics(target)
    with simulation.open_world(backend="pybullet", q=q) as world:
        for k in range(3000):
            push = np.array([0.0, -6e4 * min(k / 500, 1.0), 0.0, 0.0])
            world.step(dynamics.gravity_torque(world.q) - 6e4 * world.dq + push)
        point, force = felt_at_the_yaw_joint(world)
        assert BACKHOE.mass * BACKHOE.gravity - force > 5e3
        assert world.zero_moment_point == pytest.approx(point, abs=2e-3)
        assert point[1] < stability.centre_of_mass(world.q)[1] - 0.1
        kept = world.snapshot()
        world.reset()
        hold(world, world.q)
        world.restore(kept)
        world.step(dynamics.gravity_torque(world.q) + push)
        assert world.zero_moment_point == pytest.approx(point, abs=2e-2)


def test_a_machine_that_the_soil_lifts_off_has_no_point_and_says_what_the_ground_had_to_do():
    with simulation.open_world(backend="analytic", soil=False) as world:
        world._state.soil[2] = 1.1 * BACKHOE.mass * BACKHOE.gravity
        with pytest.raises(
            simulation.Tipped, match=r"ground had to pull while the soil held"
        ) as at:
            for _ in range(1000):
                hold(world, world.q)
        assert at.value.time < 0.5
        assert np.isnan(world.zero_moment_point).all()
        assert world.margin == -np.inf
