"""The machine that moves tracks and arm at once: joint drives, belts, what slip takes."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from backhoe import simulation
from backhoe.arm import dynamics
from backhoe.arm.dynamics import terms
from backhoe.machine import BACKHOE, variants
from backhoe.simulation import engine, servo
from backhoe.simulation.scene import FLAT
from backhoe.simulation.whole_body_plant import MOST_ADDED, WholeBodyPlant, belt_speeds
from backhoe.whole_body import circle_path, eight_path, follow, hand, jacobian, sine_path

BACKENDS = pytest.mark.parametrize("backend", ["pybullet", "analytic"])
NONE, FREE = np.zeros((2, 4)), np.full(4, np.inf)
Q = np.radians([-60.0, 25.0, -40.0, 20.0])
AHEAD = np.array([0.0, 1.0, 0.0, 0.0])


def a_world(backend="analytic", soil=False, **options):
    return simulation.open_world(backend=backend, scene=FLAT, soil=soil, **options)


def asked(q, dq, speed, angle, law=servo.speed_torque, arm=None, friction=NONE, limit=FREE, w=20.0):
    """Torque and wanted angle after one step of 1 ms."""
    arm = np.array(terms.arm_of(BACKHOE) if arm is None else arm)
    angle, torque = np.array(angle), np.empty(4)
    law(arm, friction, limit, w, np.array([q, dq]), np.array(speed), 1e-3, angle, torque)
    return torque, angle


def test_the_torque_is_that_of_the_equation_of_motion_with_the_load():
    rng = np.random.default_rng(1)
    loaded = variants.loaded(800.0, BACKHOE)
    for _ in range(10):
        q, dq, speed, angle = rng.uniform(-0.6, 0.6, (4, 4))
        ddq = 2 * 20.0 * (speed - dq) + 20.0**2 * (angle - q)
        wanted = dynamics.inverse_dynamics(q, dq, ddq, machine=loaded)
        torque, after = asked(q, dq, speed, angle, arm=terms.arm_of(loaded))
        assert_allclose(torque, wanted, rtol=1e-9)
        assert_allclose(after, angle + 1e-3 * speed, rtol=1e-12)


def test_compiled_as_plain():
    rng = np.random.default_rng(2)
    friction = np.array([BACKHOE.viscous, BACKHOE.coulomb])
    for _ in range(20):
        given = *rng.uniform(-0.6, 0.6, (4, 4)), engine.speed_torque
        found = asked(*given, friction=friction, limit=np.array(BACKHOE.torque_limit))
        plain = asked(*given[:4], friction=friction, limit=np.array(BACKHOE.torque_limit))
        assert_allclose(found, plain, rtol=1e-12, atol=1e-9)


def test_the_arm_answers_a_step_as_critical_damping_says():
    """Of s^2 e = -2 w s e - w^2 e for the angle e that is missing: 1 - exp(-w t) (1 - w t)."""
    w, step = 20.0, np.array([0.05, 0.1, -0.1, 0.2])
    q, dq, angle = Q.copy(), np.zeros(4), Q.copy()
    for tick in range(300):
        torque, angle = asked(q, dq, step, angle, w=w)
        dq = dq + 1e-3 * dynamics.forward_dynamics(q, dq, torque)
        q = q + 1e-3 * dq
        t = 1e-3 * (tick + 1)
        assert_allclose(dq, step * (1 - np.exp(-w * t) * (1 - w * t)), atol=0.02 * step.max())


def test_friction_is_made_up_for_with_the_wanted_speed():
    friction = np.array([BACKHOE.viscous, BACKHOE.coulomb])
    speed = np.array([0.1, -0.2, 0.3, 0.1])
    bare, _ = asked(Q, speed, speed, Q)
    rubbed, _ = asked(Q, speed, speed, Q, friction=friction)
    assert_allclose(rubbed - bare, dynamics.friction_torque(speed, BACKHOE, 0.01), rtol=1e-9)


def test_a_joint_at_its_limit_gathers_no_angle_and_comes_free_at_once():
    limit, speed = np.array(BACKHOE.torque_limit), np.array([0.0, 0.5, 0.0, 0.0])
    torque, angle = asked(Q, np.zeros(4), speed, Q + AHEAD, limit=limit)
    assert torque[1] == limit[1]
    assert angle[1] == Q[1] + 1.0
    torque, angle = asked(Q, np.zeros(4), -speed, Q + AHEAD, limit=limit)
    assert angle[1] < Q[1] + 1.0


@BACKENDS
def test_after_a_moment_the_machine_has_the_velocities_it_was_told(backend):
    v = np.array([0.3, 0.08, 0.1, 0.06, -0.1, 0.15])
    with a_world(backend) as world:
        plant = WholeBodyPlant(world)
        for _ in range(200):
            plant.step(v)
        assert_allclose(plant.v, v, atol=2e-3)
        turned = plant.q[3:] - world._start
        assert_allclose(turned[1:], 2.0 * v[3:], atol=5e-4)
        assert 0.19 < turned[0] < 0.2  # the swing's drive was at its limit when it started
        assert plant.time == pytest.approx(2.0)


def test_belts_that_know_of_no_slip_turn_the_machine_too_little():
    turned = {}
    for turning in (0.0, 4.0):
        with a_world() as world:
            plant = WholeBodyPlant(world, turning=turning)
            for _ in range(300):
                plant.step([0.2, 0.1, 0, 0, 0, 0])
            turned[turning] = plant.v[1]
    assert 0.065 < turned[0.0] < 0.08
    assert turned[4.0] == pytest.approx(0.1, abs=1e-3)


def test_a_held_machine_gathers_no_more_than_a_little_turn():
    with a_world() as world:
        plant = WholeBodyPlant(world)
        for _ in range(300):
            plant.step([0, 3.0, 0, 0, 0, 0])
        assert plant._missing == MOST_ADDED


def test_the_load_in_the_bucket_is_carried_at_once():
    with a_world(soil=True) as world:
        plant = WholeBodyPlant(world)
        world.ground.bucket_volume = 0.6
        for _ in range(60):
            plant.step(np.zeros(6))
        assert world.ground.payload > 800
        assert_allclose(plant.q[3:], world._start, atol=2e-3)


@BACKENDS
def test_two_runs_are_the_same_to_the_last_bit(backend):
    ends = []
    for _ in range(2):
        with a_world(backend, soil=True) as world:
            plant = WholeBodyPlant(world)
            for k in range(60):
                plant.step(0.2 * np.sin(0.1 * k + np.arange(6)))
            ends.append(np.r_[plant.q, plant.v])
    assert_array_equal(*ends)


def test_both_backends_move_alike():
    ends = []
    for backend in ("pybullet", "analytic"):
        with a_world(backend, soil=True) as world:
            plant = WholeBodyPlant(world)
            for k in range(100):
                plant.step(0.2 * np.sin(0.1 * k + np.arange(6)))
            ends.append(plant.q)
    assert_allclose(*ends, atol=1e-4)


def test_after_a_reset_the_arm_stays_where_it_is_put():
    with a_world() as world:
        plant = WholeBodyPlant(world)
        for _ in range(30):
            plant.step([0.2, 0.2, 0.3, 0.1, 0.1, 0.1])
        world.reset(Q)
        plant.wake()
        for _ in range(50):
            plant.step(np.zeros(6))
        assert_allclose(plant.q, [0, 0, 0, *Q], atol=1e-3)


def test_the_belts_of_a_turn():
    assert_allclose(belt_speeds(0.5, 0.2), 0.5 + np.array([-1, 1]) * 0.1 * BACKHOE.tracks.gauge)


def test_bad_arguments():
    with a_world() as world:
        for options in ({"dt": 0.0105}, {"bandwidth": 0.0}, {"turning": -1.0}):
            with pytest.raises(ValueError, match=next(iter(options))):
                WholeBodyPlant(world, **options)
        plant = WholeBodyPlant(world)
        with pytest.raises(ValueError, match="u, omega and the speeds"):
            plant.step(np.zeros(4))
        with pytest.raises(ValueError, match="v"):
            plant.step([np.nan, 0, 0, 0, 0, 0])
    with a_world(base="fixed") as world, pytest.raises(ValueError, match="fixed base"):
        WholeBodyPlant(world)


# The hand along a path

READY = np.radians([-80.0, 29.0, -34.0, 34.0])
AT = hand([0, 0, 0, *READY])
PATHS = {
    "sine": sine_path(AT, 8, length=1.6, waves=1, sideways=0.35, upwards=0.2),
    "circle": circle_path(AT, 8, radius=0.4, tilt=0.4),
    "eight": eight_path(AT, 8, length=1.0, width=0.5, height=0.25),
}


def followed(path, W, backend="analytic", **options):
    def keep(q):
        return np.r_[0, 0, 0.5 * (READY - q[3:])]

    with a_world(backend, q=READY) as world:
        return follow(WholeBodyPlant(world, **options), path, W=W, preferred=keep)


def rms(run):
    return float(np.sqrt((run.error**2).mean()))


@pytest.mark.parametrize("kind", PATHS)
def test_what_slip_takes_from_a_turn_stays_as_an_error_until_the_belts_make_up_for_it(kind):
    """A share is missing of each turn: T / (1 - W) times the speed that it takes from the hand."""
    W = 0.9
    plain, mended = (followed(PATHS[kind], W, turning=gain) for gain in (0.0, 4.0))
    lever = np.linalg.norm(jacobian(plain.q)[:-1, :, 1], axis=1)
    expected = 0.01 / (1 - W) * 0.27 * np.abs(plain.told[:, 1]) * lever
    assert rms(plain) == pytest.approx(np.sqrt((expected**2).mean()), rel=0.15)
    assert rms(mended) < 0.5 * rms(plain)


@pytest.mark.parametrize("kind", PATHS)
def test_the_bucket_follows_a_path_to_two_millimetres(kind):
    run = followed(PATHS[kind], 0.8)
    assert rms(run) < 1.5e-3
    assert run.error.max() < 3e-3
    assert np.abs(np.diff(run.told[100:], axis=0)).max() < 5e-3  # quietly


def test_feedback_faster_than_the_drives_shakes_the_machine():
    """(1 - W) / T of 50 a second, where the joints' drives follow up to 25 rad/s."""
    run = followed(PATHS["circle"], 0.5)
    assert rms(run) > 5 * rms(followed(PATHS["circle"], 0.8))
    assert np.abs(np.diff(run.told[100:], axis=0)).max() > 0.01


def test_both_backends_follow_alike():
    runs = [followed(PATHS["eight"], 0.8, backend) for backend in ("analytic", "pybullet")]
    assert_allclose(runs[0].q, runs[1].q, atol=1e-6)
