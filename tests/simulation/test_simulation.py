"""What every simulation promises: time, limits, soil, snapshots, determinism, calm errors."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from backhoe import simulation
from backhoe.arm import dynamics, kinematics
from backhoe.machine import BACKHOE
from backhoe.simulation import backends, engine, forces
from backhoe.simulation.loop import REST

STIFF = np.array([1.2e6, 1.5e6, 4e5, 1.2e5]), np.array([4e5, 3e5, 6e4, 1.5e4])
DIG = np.radians([[-90, 12, -4, 84], [-90, 10, -29, 83], [-90, -1, -12, 6], [-90, 28, 0, -36]])


@pytest.fixture(params=["pybullet", "analytic"])
def backend(request):
    if request.param == "pybullet":
        pytest.importorskip("pybullet")
    return request.param


@pytest.fixture
def world(backend):
    with simulation.open_world(backend=backend) as opened:
        yield opened


def follow(world, way, seconds):
    """Drive the joints from way-point to way-point, gently; the log of coordinates and soil."""
    kp, kd = STIFF
    steps = round(seconds / world.dt)
    way = np.vstack([world.q, way])
    log = []
    for k in range(steps):
        at = k / steps * (len(way) - 1)
        leg, share = int(at), at % 1.0
        q_ref = way[leg] + share**2 * (3 - 2 * share) * (way[leg + 1] - way[leg])
        torque = kp * (q_ref - world.q) - kd * world.dq + dynamics.gravity_torque(world.q)
        world.step(torque)
        log.append([*world.pose, *world.q, *world.twist, *world.dq, world.ground.bucket_volume])
    return np.array(log)


def test_both_backends_are_one_machine():
    pytest.importorskip("pybullet")
    with (
        simulation.open_world(backend="pybullet") as one,
        simulation.open_world(backend="analytic") as other,
    ):
        for k in range(800):
            push = np.array([6e4 * np.sin(0.01 * k), 2e4, -1e4, 3e3])
            torque = dynamics.gravity_torque(one.q) + push
            for world in (one, other):
                world.step(torque, (0.9, -0.4))
        assert np.abs(one.pose).max() > 0.05
        np.testing.assert_allclose(one.q, other.q, atol=1e-10)
        np.testing.assert_allclose(one.pose, other.pose, atol=1e-10)
        np.testing.assert_allclose(one.dq, other.dq, atol=1e-9)


def test_both_backends_dig_the_same_soil():
    pytest.importorskip("pybullet")
    logs = []
    for backend in ("pybullet", "analytic"):
        with simulation.open_world(backend=backend) as world:
            logs.append(follow(world, DIG, 8.0))
    loading = slice(0, 6000)
    assert logs[0][loading][-1, -1] > 0.4
    # Later, soil that slides in one world and just stands in the other makes round-off grow.
    np.testing.assert_allclose(logs[0][loading], logs[1][loading], atol=1e-9)


def test_digging_keeps_the_soil_and_the_place(world):
    total = world.ground.total_volume
    log = follow(world, DIG, 8.0)
    assert log[-1, -1] > 0.1
    assert world.ground.total_volume == pytest.approx(total, rel=1e-9)
    assert np.abs(log[:, :2]).max() < 0.02


def test_the_load_rides_at_the_buckets_centre_of_mass(backend):
    bucket = BACKHOE.bucket
    loaded = replace(BACKHOE, bucket=replace(bucket, mass=bucket.mass + 700.0))
    with simulation.open_world(backend=backend, soil=False, base="fixed", friction=False) as world:
        world._load(700.0)
        world.step(np.zeros(4))
        expected = dynamics.forward_dynamics(REST, np.zeros(4), np.zeros(4), machine=loaded)
        np.testing.assert_allclose(world.dq / world.dt, expected, rtol=1e-6, atol=1e-9)


def test_time_counts_steps(world):
    for _ in range(250):
        world.step(dynamics.gravity_torque(world.q))
    assert world.time == 0.25


def test_torques_are_cut_at_the_actuators_limit_and_reported(world):
    world.step([1e9, -1e9, 5.0, 0.0])
    limit = BACKHOE.torque_limit
    np.testing.assert_array_equal(world.torque, [limit[0], -limit[1], 5.0, 0.0])


@pytest.mark.parametrize("joint", range(4))
@pytest.mark.parametrize("end", ["lower", "upper"])
def test_stops_hold_the_joints_against_full_torque(backend, joint, end):
    limit = getattr(BACKHOE, end)[joint]
    q = np.zeros(4)
    q[joint] = limit - 0.05 * np.sign(limit)
    with simulation.open_world(
        backend=backend, scene=simulation.FLAT, soil=False, base="fixed", q=q
    ) as world:
        push = np.zeros(4)
        push[joint] = 0.8 * BACKHOE.torque_limit[joint] * np.sign(limit)
        kp, kd = STIFF
        others = np.arange(4) != joint
        furthest = 0.0
        for _ in range(2500):
            hold = dynamics.gravity_torque(world.q) + others * (kp * (q - world.q) - kd * world.dq)
            world.step(hold + push)
            furthest = max(furthest, (world.q[joint] - limit) * np.sign(limit))
        assert 0.0 < (world.q[joint] - limit) * np.sign(limit) < forces.STOP_TRAVEL
        assert abs(world.dq[joint]) < 0.02
        assert furthest < np.radians(6)


def test_joint_friction_stops_a_swinging_arm_and_can_be_left_out(backend):
    speeds = []
    for friction in (True, False):
        with simulation.open_world(
            backend=backend, soil=False, base="fixed", friction=friction
        ) as world:
            for k in range(3000):
                swing = 4e4 if k < 1000 else 0.0
                hold = dynamics.gravity_torque(world.q) + dynamics.coriolis_matrix(
                    world.q, world.dq
                ) @ world.dq * [0, 1, 1, 1]
                world.step(hold + swing * np.eye(4)[0])
            speeds.append(world.dq[0])
    assert speeds[0] < 0.95 * speeds[1]


def test_resting_against_friction_is_still(world):
    start = world.q
    for _ in range(2000):
        world.step(dynamics.gravity_torque(start) + 0.2 * BACKHOE.coulomb)
    assert np.abs(world.dq).max() < forces.COULOMB_SMOOTHING


def test_soil_at_the_tip_acts_through_the_transposed_jacobian(backend):
    force = np.array([3e3, -2e3, 5e3])
    with simulation.open_world(backend=backend, soil=False, base="fixed", friction=False) as world:
        world._state.soil[:3] = force
        world.step(np.zeros(4))
        J = kinematics.jacobian(REST)[:3]
        expected = dynamics.forward_dynamics(REST, np.zeros(4), J.T @ force)
        np.testing.assert_allclose(world.dq / world.dt, expected, rtol=1e-9)


def test_tip_motion_is_the_forward_kinematics_of_a_moving_vehicle(world):
    rng = np.random.default_rng(3)
    q, dq, h = rng.uniform(-1, 1, 7), rng.uniform(-1, 1, 7), 1e-6
    reach = world._numbers.reach
    T, velocity = engine.tip_motion(reach, q, dq)
    c, s = np.cos(q[2]), np.sin(q[2])
    T_world_base = np.array([[c, -s, 0, q[0]], [s, c, 0, q[1]], [0, 0, 1, 0], [0, 0, 0, 1]])
    np.testing.assert_allclose(T, T_world_base @ kinematics.forward_kinematics(q[3:]), atol=1e-12)
    ahead, behind = (engine.tip_motion(reach, q + sign * h * dq, dq)[0] for sign in (1, -1))
    np.testing.assert_allclose(velocity, (ahead - behind)[:3, 3] / (2 * h), atol=1e-7)


def test_the_same_seed_and_inputs_repeat_bit_for_bit(backend):
    logs = []
    for _ in range(2):
        with simulation.open_world(backend=backend, seed=4) as world:
            logs.append(follow(world, DIG[:3], 5.0))
    np.testing.assert_array_equal(*logs)


def test_another_seed_is_another_heap():
    heaps = [simulation.LOADING.heights(seed) for seed in (0, 0, 1)]
    np.testing.assert_array_equal(heaps[0], heaps[1])
    assert np.abs(heaps[0] - heaps[2]).max() > 0.003


def test_a_snapshot_in_the_middle_of_the_dig_goes_on_bit_for_bit(world):
    follow(world, DIG[:2], 3.0)
    there = world.snapshot()
    time, volume = world.time, world.ground.bucket_volume
    first = follow(world, DIG[2:], 3.0)
    world.restore(there)
    assert (world.time, world.ground.bucket_volume) == (time, volume)
    np.testing.assert_array_equal(follow(world, DIG[2:], 3.0), first)


def test_reset_forgets_everything(world):
    first = follow(world, DIG[:2], 3.0)
    world.reset()
    assert world.time == 0.0
    np.testing.assert_array_equal(follow(world, DIG[:2], 3.0), first)


def test_reset_puts_the_machine_where_it_is_told(world):
    world.reset(q=[0.1, 0.2, 0.3, 0.4], pose=[1.0, -2.0, 0.5])
    np.testing.assert_array_equal(world.q, [0.1, 0.2, 0.3, 0.4])
    np.testing.assert_array_equal(world.pose, [1.0, -2.0, 0.5])


def test_two_simulations_run_side_by_side(backend):
    with simulation.open_world(backend=backend) as alone:
        expected = follow(alone, DIG[:1], 1.0)
    with (
        simulation.open_world(backend=backend) as one,
        simulation.open_world(backend=backend) as other,
    ):
        one.step(np.zeros(4))
        one.reset()
        got = []
        kp, kd = STIFF
        way = np.vstack([one.q, DIG[:1]])
        for k in range(1000):
            share = k / 1000
            q_ref = way[0] + share**2 * (3 - 2 * share) * (way[1] - way[0])
            torque = kp * (q_ref - one.q) - kd * one.dq + dynamics.gravity_torque(one.q)
            one.step(torque)
            other.step(0.5 * torque)
            got.append([*one.q])
        assert np.abs(other.q - one.q).max() > 0.1
    np.testing.assert_array_equal(np.array(got), expected[:, 3:7])


def test_what_is_handed_out_is_a_copy(world):
    for name in ("q", "dq", "pose", "twist", "torque", "belts", "soil_force"):
        getattr(world, name)[:] = 99.0
        assert not (getattr(world, name) == 99.0).any()


@pytest.mark.parametrize(
    "torque, belts, message",
    [
        ([1.0, 2.0, 3.0], (0, 0), r"torque must be joints .* got shape \(3,\)"),
        (np.zeros((4, 1)), (0, 0), r"torque .* got shape \(4, 1\)"),
        ([0, 0, np.nan, 0], (0, 0), "torque must be finite, got nan at index 2"),
        ([0, 0, np.inf, 0], (0, 0), "torque must be finite"),
        ([0, 0, "full", 0], (0, 0), "torque must be numbers"),
        (np.zeros(4), (0.0,), r"belts must be left and right .* got shape \(1,\)"),
        (np.zeros(4), (np.nan, 0), "belts must be finite"),
    ],
)
def test_a_bad_step_says_what_is_wrong_and_changes_nothing(world, torque, belts, message):
    before = world.q
    with pytest.raises(ValueError, match=message):
        world.step(torque, belts)
    assert world.time == 0.0
    np.testing.assert_array_equal(world.q, before)


@pytest.mark.parametrize(
    "bad, error, message",
    [
        ({"machine": "pybullet"}, TypeError, "machine must be a Machine, got str"),
        ({"scene": "x"}, TypeError, "scene must be a Scene, got str"),
        ({"seed": None}, ValueError, "seed must be one whole number at least 0, got None"),
        (
            {"backend": "gazebo"},
            ValueError,
            "backend must be one of auto, pybullet, analytic, got 'gazebo'",
        ),
        ({"base": "wheels"}, ValueError, "base must be one of tracks, fixed, got 'wheels'"),
        ({"q": [0.0, 1.0]}, ValueError, r"q must be joints .* got shape \(2,\)"),
        ({"q": [0.0, 1.0, np.nan, 0.0]}, ValueError, "finite"),
        ({"q": np.zeros((2, 4))}, ValueError, r"shape \(4,\), got shape \(2, 4\)"),
    ],
)
def test_a_world_that_cannot_be_opened_says_why(bad, error, message):
    with pytest.raises(error, match=message):
        simulation.open_world(**{"backend": "analytic", **bad})


def test_bad_resets_are_refused(world):
    with pytest.raises(ValueError, match="pose must be finite"):
        world.reset(pose=[0.0, np.nan, 0.0])
    with pytest.raises(ValueError, match="q must be joints"):
        world.reset(q=[1.0])


def test_a_fixed_base_cannot_be_put_elsewhere(backend):
    with simulation.open_world(backend=backend, base="fixed", soil=False) as world:
        with pytest.raises(ValueError, match="fixed base"):
            world.reset(pose=[1.0, 0.0, 0.0])


def test_a_snapshot_of_another_simulation_is_refused(world):
    with simulation.open_world(backend="analytic") as other:
        with pytest.raises(ValueError, match="of this very simulation"):
            world.restore(other.snapshot())


def test_a_closed_simulation_says_so(backend):
    world = simulation.open_world(backend=backend)
    there = world.snapshot()
    world.close()
    world.close()
    for use in (
        lambda: world.step(np.zeros(4)),
        world.reset,
        world.snapshot,
        lambda: world.restore(there),
        world.__enter__,
    ):
        with pytest.raises(RuntimeError, match=r"closed: open a new one"):
            use()


def test_a_machine_that_runs_away_is_stopped_with_the_reason(world):
    with pytest.raises(RuntimeError, match=r"ran away at t = .*wrong sign"):
        for _ in range(3000):
            world.step(5e6 * world.dq + np.array([1e3, 0, 0, 0]) + dynamics.gravity_torque(world.q))


def test_without_pybullet_auto_says_one_line_and_goes_on(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "pybullet", None)
    monkeypatch.setattr(backends, "_announced", False)
    for _ in range(2):
        with simulation.open_world() as world:
            assert world.backend == "analytic"
            world.step(np.zeros(4))
    printed = capsys.readouterr()
    assert printed.out == backends.FALLBACK + "\n"
    assert printed.err == ""


def test_without_pybullet_asking_for_it_names_the_fix(monkeypatch):
    monkeypatch.setitem(sys.modules, "pybullet", None)
    with pytest.raises(ImportError, match="pip install pybullet"):
        simulation.open_world(backend="pybullet")


def test_the_analytic_backend_has_no_camera():
    with simulation.open_world(backend="analytic", soil=False) as world:
        with pytest.raises(RuntimeError, match="install PyBullet"):
            world.render(64, 48)


def test_importing_sim_is_light_and_opening_prints_nothing():
    pytest.importorskip("pybullet")
    code = (
        "import sys; from backhoe import simulation; "
        "assert not {'pybullet', 'numba', 'scipy'} & set(sys.modules); "
        "w = simulation.open_world(backend='pybullet', soil=False); w.step([0, 0, 0, 0]); w.close()"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")


def test_soil_is_felt_only_in_it(world):
    for _ in range(20):
        world.step(dynamics.gravity_torque(world.q))
    assert not world.ground.touches and not world.soil_force.any()
    follow(world, DIG[:2], 3.0)
    assert world.ground.touches and np.linalg.norm(world.soil_force) > 1e3


def test_the_soil_is_told_how_fast_the_bucket_turns(world, monkeypatch):
    """At visits and in between: the change of the bucket's pitch from step to step."""
    told, ground = [], world.ground
    for name, at in (("advance", 3), ("force", 2)):
        asked = getattr(ground, name)
        monkeypatch.setattr(
            ground, name, lambda *call, a=asked, at=at: (told.append(call[at]), a(*call))[1]
        )
    world._in_soil, pitches = True, []
    for _ in range(25):
        world.step(dynamics.gravity_torque(world.q) + np.array([0.0, 2e4, -1e4, 8e3]))
        world._in_soil = True
        pitches.append(world.q[1:].sum())
    turned = np.diff(pitches) / world.dt
    assert np.abs(turned).max() > 0.1
    assert told[1:] == pytest.approx(turned, rel=1e-6)
