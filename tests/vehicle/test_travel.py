"""Travelling: the two PI loops and their step models."""

import control
import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from backhoe.basics.se2 import sides_of_twist
from backhoe.lessons import published
from backhoe.machine import BACKHOE, replace
from backhoe.simulation.urdf import urdf
from backhoe.vehicle import motor, travel
from backhoe.vehicle.travel import StepModel, VelocityPI

TRACK = BACKHOE.tracks
NARROW, WIDE = (replace(BACKHOE, tracks=replace(TRACK, gauge=gauge)) for gauge in (2.0, 2.6))
LOOPS = [
    StepModel(19.5e3, 240e3, 180e3),
    StepModel(60e3, 100e3, 180e3),
    StepModel(10.0, 40.0, 40.0),
    StepModel(20.0, 30.0, 6.0, 12.0),
    StepModel(5.0, 20.0, 15.0, 3.75),
]


# The control law


def test_the_printed_gains_are_those_of_table_32():
    kp, ki = travel.GAINS
    table = published.load("mastalli_2013_table_32")
    assert list(kp) == [table["translation"]["kp"], table["rotation"]["kp"]]
    assert list(ki) == [table["translation"]["ki"], table["rotation"]["ki"]]
    np.testing.assert_array_equal(VelocityPI().kp, kp)


@pytest.mark.parametrize("machine", [BACKHOE, NARROW, WIDE])
def test_with_the_lever_it_is_a_pi_on_each_tracks_own_error(machine):
    gauge, dt = machine.tracks.gauge, 0.02
    controller = VelocityPI(limit=np.inf, lever=gauge / 2)
    (kp, _), (ki, _) = travel.GAINS
    rng = np.random.default_rng(3)
    sums = np.zeros(2)
    for _ in range(20):
        v_ref, omega_ref, v, omega = rng.uniform(-1, 1, 4)
        errors = np.array(sides_of_twist(v_ref - v, omega_ref - omega, gauge))  # of each sprocket
        sums += errors * dt
        forces = controller(v_ref, omega_ref, v, omega, dt)
        np.testing.assert_allclose(forces, kp * errors + ki * sums, rtol=1e-12)


def test_the_lever_is_1_m_on_a_gauge_of_2_m_alone_and_ours_is_longer():
    arguments = (0.5, 0.2, 0.4, 0.1, 0.02)
    left, right = VelocityPI(limit=np.inf)(*arguments)
    assert (left, right) == VelocityPI(limit=np.inf, lever=NARROW.tracks.gauge / 2)(*arguments)
    for machine in (BACKHOE, WIDE):
        lever = machine.tracks.gauge / 2
        with_lever = VelocityPI(limit=np.inf, lever=lever)(*arguments)
        assert with_lever[1] - with_lever[0] == pytest.approx(lever * (right - left))
        assert sum(with_lever) == pytest.approx(left + right)
    assert TRACK.gauge / 2 == pytest.approx(1.19)


def test_no_track_is_asked_for_more_than_its_drive_gives_and_turning_comes_first():
    controller = VelocityPI()
    left, right = controller(5.0, 0.2, 0.0, 0.0, 0.02)
    assert max(abs(left), abs(right)) == pytest.approx(TRACK.max_traction)
    assert (right - left) / 2 == pytest.approx(120e3 * 0.2 + 90e3 * 0.2 * 0.02)


def test_integrals_do_not_grow_at_the_limit_and_come_back_at_once():
    controller = VelocityPI()
    for _ in range(500):
        controller(2.0, 0.0, 0.0, 0.0, 0.02)
    np.testing.assert_array_equal(controller.integral, [0.0, 0.0])
    free = VelocityPI(limit=np.inf)
    for _ in range(500):
        free(2.0, 0.0, 0.0, 0.0, 0.02)
    assert free.integral[0] == pytest.approx(20.0)
    left, _ = controller(0.0, 0.0, 0.1, 0.0, 0.02)
    assert left < 0 < free(0.0, 0.0, 0.1, 0.0, 0.02)[0]


def test_an_integral_at_the_limit_may_come_back():
    control = travel.VelocityPI(kp=(1.0, 1.0), ki=(100.0, 0.0), limit=10.0)
    control(0.9, 0.0, 0.0, 0.0, 0.1)
    assert control.integral[0] == pytest.approx(0.09)
    forces = control(-0.1, 20.0, 0.0, 0.0, 0.1)
    assert forces == pytest.approx((-10.0, 10.0))
    assert control.integral[0] == pytest.approx(0.08)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_no_track_is_asked_for_more_than_the_limit_in_either_turn(side):
    control = travel.VelocityPI(kp=(1.0, 1.0), ki=(0.0, 0.0), limit=10.0)
    left, right = control(50.0, side * 4.0, 0.0, 0.0, 0.1)
    assert (left + right) / 2 == pytest.approx(6.0)
    assert (right - left) / 2 == pytest.approx(side * 4.0)


def test_reset_forgets_the_integrals():
    controller = VelocityPI(limit=np.inf)
    first = controller(0.3, 0.1, 0.0, 0.0, 0.02)
    controller.reset()
    assert controller(0.3, 0.1, 0.0, 0.0, 0.02) == first


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"kp": 120e3}, r"kp must be gains \(translational, rotational\), shape \(2,\)"),
        ({"ki": (-1.0, 0.0)}, "ki must be one number at least 0"),
        ({"kp": (np.nan, 1.0)}, "kp must be finite"),
        ({"kp": ("a", "b")}, "kp must be numbers"),
        ({"limit": 0.0}, r"limit must be one number above 0 \[N\], got 0.0"),
        ({"limit": np.nan}, "limit must be one number above 0"),
        ({"lever": np.inf}, "lever must be one number above 0"),
        ({"lever": "1"}, "lever must be one number above 0, got '1'"),
    ],
)
def test_a_malformed_controller_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        VelocityPI(**arguments)


def test_speeds_that_are_not_finite_and_times_that_do_not_pass_are_refused():
    controller = VelocityPI()
    for k, name in enumerate(("v_ref", "omega_ref", "v", "omega")):
        speeds = [0.0] * 4
        speeds[k] = np.nan
        with pytest.raises(ValueError, match=f"^{name} must be one finite number"):
            controller(*speeds, 0.02)
    with pytest.raises(ValueError, match="dt must be one number above 0"):
        controller(0.0, 0.0, 0.0, 0.0, 0.0)


# The step models


@pytest.mark.parametrize("loop", LOOPS)
def test_the_response_solves_the_equation_of_motion(loop):
    def rate(t, state):
        y, integral = state
        u = loop.kp * (1 - y) + loop.ki * integral
        return (u - loop.damping * y) / loop.inertia, 1 - y

    t = np.linspace(0, 6, 61)
    y, _ = solve_ivp(rate, (0, 6), [0, 0], "DOP853", t, rtol=1e-11, atol=1e-12).y
    np.testing.assert_allclose(loop.response(t), y, atol=1e-9)


@pytest.mark.parametrize("loop", LOOPS)
def test_the_overshoot_is_that_of_python_control(loop):
    closed = control.tf([loop.kp, loop.ki], [loop.inertia, loop.damping + loop.kp, loop.ki])
    info = control.step_info(closed, T=np.linspace(0, 20, 200_001))
    assert 100 * loop.overshoot == pytest.approx(info["Overshoot"], abs=1e-3)


def test_without_damping_the_integral_of_the_error_is_zero_so_the_step_overshoots():
    for loop in LOOPS[:3]:
        lacking, _ = quad(lambda t, loop=loop: 1 - loop.response(t), 0, 60, limit=500)
        assert lacking == pytest.approx(0.0, abs=1e-6)
        assert loop.overshoot > 0


def test_damping_that_cancels_the_zero_leaves_no_overshoot():
    assert LOOPS[4].overshoot < 1e-12
    assert StepModel(10.0, 40.0, 0.0).overshoot == 0.0


def test_the_model_counts_both_tracks_and_the_belts_along():
    translation, rotation = travel.model()
    assert translation.inertia == BACKHOE.mass + 2 * TRACK.belt_mass
    assert (translation.kp, translation.ki) == (240e3, 180e3)
    assert rotation.kp == 120e3 * TRACK.gauge
    assert travel.model(WIDE).rotation.kp == pytest.approx(120e3 * 2.6)


def test_tracks_turn_the_machine_and_their_belts_about_their_middle():
    inertia, com = travel.yaw_inertia()
    belts = 2 * TRACK.belt_mass * (TRACK.gauge / 2) ** 2
    turned = inertia + BACKHOE.mass * com @ com + belts
    assert travel.model().rotation.inertia == pytest.approx(turned)
    assert BACKHOE.mass * com @ com > 0.01 * turned


def test_yaw_inertia_is_that_of_the_simulated_bodies(tmp_path):
    pybullet = pytest.importorskip("pybullet")
    client = pybullet.connect(pybullet.DIRECT)
    path = tmp_path / "machine.urdf"
    path.write_text(urdf(BACKHOE))
    body = pybullet.loadURDF(str(path), useFixedBase=True, flags=2, physicsClientId=client)
    rng = np.random.default_rng(4)
    for _ in range(5):
        q = rng.uniform(BACKHOE.lower, BACKHOE.upper)
        inertia, com = travel.yaw_inertia(q)
        M = np.array(
            pybullet.calculateMassMatrix(body, [0.0, 0.0, 0.0, *q], physicsClientId=client)
        )
        np.testing.assert_allclose(M[2, :2], BACKHOE.mass * np.array([-com[1], com[0]]), atol=1e-6)
        assert M[2, 2] == pytest.approx(inertia + BACKHOE.mass * com @ com, rel=1e-9)
    pybullet.disconnect(client)


def settled(loop, band=0.02):
    t = np.linspace(0, 30, 60_001)
    return motor.settling_time(t, loop.response(t), 1.0, band)


def test_the_overshoot_of_table_33_belongs_to_16_t_and_its_settling_time_to_8_t():
    table = published.load("mastalli_2013_table_33")["translation"]
    kp, ki = (2 * gain[0] for gain in travel.GAINS)
    heavy, light = StepModel(16.2e3, kp, ki), StepModel(7.8e3, kp, ki)
    assert 100 * heavy.overshoot == pytest.approx(table["overshoot_percent"], rel=0.02)
    assert settled(light) == pytest.approx(table["settling_time"], rel=0.02)
    assert settled(heavy) > 3 * table["settling_time"]
    assert 100 * light.overshoot < 0.6 * table["overshoot_percent"]


def test_to_5_percent_no_mass_takes_as_long_as_table_33():
    table = published.load("mastalli_2013_table_33")["translation"]
    kp, ki = (2 * gain[0] for gain in travel.GAINS)
    times = [settled(StepModel(m, kp, ki), 0.05) for m in np.geomspace(1e3, 2e4, 60)]
    assert max(times) < table["settling_time"]


def test_no_undamped_inertia_has_the_rotation_of_table_33():
    table = published.load("mastalli_2013_table_33")["rotation"]
    kp, ki = (TRACK.gauge * gain[1] for gain in travel.GAINS)
    assert table["overshoot_percent"] == 0
    loops = [StepModel(inertia, kp, ki) for inertia in np.geomspace(1e3, 1e5, 31)]
    assert all(loop.overshoot > 0 for loop in loops)
    late = [loop for loop in loops if settled(loop) >= table["settling_time"]]
    assert min(loop.overshoot for loop in late) > 0.02


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: StepModel(0.0, 1.0, 1.0), "StepModel.inertia must be one number above 0"),
        (lambda: StepModel(1.0, 1.0, -1.0), "StepModel.ki must be one number at least 0"),
        (lambda: StepModel(1.0, 1.0, 1.0).response([-1.0]), "t must be 0 s or more"),
        (lambda: StepModel(1.0, 1.0, 1.0).response(np.inf), "t must be finite"),
        (lambda: travel.yaw_inertia(np.zeros(3)), r"q must be joints .* shape \(4,\)"),
    ],
)
def test_a_malformed_model_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_what_is_given_keeps_the_limit_and_the_turn_has_all_that_it_can():
    rng = np.random.default_rng(9)
    for u_v, u_omega in rng.uniform(-2, 2, (200, 2)):
        given_v, given_omega = travel.limited(u_v, u_omega, 1.0)
        assert abs(given_v) + abs(given_omega) <= 1 + 1e-12
        assert given_omega == pytest.approx(np.sign(u_omega) * min(abs(u_omega), 1))
        free = 1 - abs(given_omega)
        assert given_v == pytest.approx(np.sign(u_v) * min(abs(u_v), free))
    with pytest.raises(ValueError, match="limit"):
        travel.limited(1.0, 1.0, 0.0)


def test_two_tracks_make_a_force_and_a_moment():
    left, right = travel.tractions(3e4, -2e4, 2.38)
    assert left + right == pytest.approx(3e4)
    assert (right - left) * 2.38 / 2 == pytest.approx(-2e4)
    with pytest.raises(ValueError, match="gauge"):
        travel.tractions(1.0, 1.0, 0.0)
