"""What the PUCP guide prints, and Mastalli in section 4.1, judged."""

import numpy as np
import pytest

from backhoe.lessons.odometry import printed
from backhoe.localisation import odometry
from backhoe.localisation.odometry import streaming
from backhoe.machine import BACKHOE
from backhoe.vehicle.tracks import tracks_twist

ROBOT = odometry.differential(0.35, 2.0)
MOVING, RESTING = odometry.winding(), odometry.winding(swing=-0.6)
RADIUS, GAUGE = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge


def wheels(v, omega):
    return ROBOT.wheel_speeds(np.stack([v, 0 * v, omega], axis=-1))


def order_of(algorithm, motion, steps=(200, 400, 800, 1600)):
    """Order of an algorithm that takes f, times and samples, from the first sample's time on."""

    def end(t, v, omega):
        return algorithm(ROBOT.rate, t, wheels(v, omega))

    dt, errors = odometry.final_errors(end, steps, motion)
    return odometry.order(dt, errors), errors


def quasi_rectangle(T=0.01, turn=0.3):
    """67 s at 0.5 m/s: four sides, four corners; v and omega held over T."""
    corner = np.full(round(np.pi / 2 / turn / T), np.pi / 2 / T / round(np.pi / 2 / turn / T))
    sides = (67 - 4 * T * len(corner)) / 4
    straight = np.zeros(round(sides / T))
    omega = np.tile(np.r_[straight, corner], 4)
    return np.full(len(omega), 0.5), omega


def rmse(poses, truth):
    return np.sqrt(np.mean(np.sum((poses - truth)[:, :2] ** 2, axis=1)))


def mastalli(v, omega, T=0.01):
    right, left = (v + omega * GAUGE / 2) / RADIUS, (v - omega * GAUGE / 2) / RADIUS

    def step(pose, Omega_r, Omega_l, T):
        return printed.mastalli_algorithm_1(pose, Omega_r, Omega_l, RADIUS, GAUGE, T)

    return printed.roll_out(step, np.zeros(3), right, left, T=T)


@pytest.mark.parametrize("name", ["algorithm_1", "algorithm_2"])
def test_algorithms_1_and_2_are_7_and_8_when_the_clock_starts_at_0_and_the_robot_rests(name):
    rng = np.random.default_rng(1)
    J, t = rng.normal(size=(3, 2)), np.linspace(0, 3, 40)
    u = rng.normal(size=(40, 2))
    u[0] = 0.0
    step = streaming.euler if name == "algorithm_1" else streaming.heun
    np.testing.assert_allclose(
        getattr(printed, name)(J, t, u),
        streaming.run(step, streaming.linear(J), t, u, np.zeros(3)),
        atol=1e-12,
    )


def test_a_clock_that_does_not_start_at_0_makes_the_first_step_of_algorithm_2_jump_by_half():
    jump = printed.algorithm_2(np.eye(1), [1000.0, 1000.1], np.ones((2, 1)))[0]
    assert jump[0] == pytest.approx(500.0)


def test_algorithm_3_is_explicit_euler_with_the_new_sample():
    t = MOVING.instants(100)
    u = wheels(MOVING.v(t), MOVING.omega(t))
    np.testing.assert_allclose(
        printed.algorithm_3(ROBOT.rate, t, u),
        streaming.run(streaming.euler, ROBOT.rate, t, u, np.zeros(3)),
        atol=1e-12,
    )
    order, _ = order_of(printed.algorithm_3, MOVING)
    assert order == pytest.approx(1, abs=0.03)


@pytest.mark.parametrize("motion", [MOVING, RESTING], ids=["moving", "from rest"])
def test_algorithm_4_as_executed_is_of_order_1_where_a_predictor_makes_2(motion):
    order, errors = order_of(printed.algorithm_4, motion)
    assert order == pytest.approx(1, abs=0.1)

    def heun(f, t, u):
        return streaming.run(streaming.heun, f, t, u, np.zeros(3))

    better, smaller = order_of(heun, motion)
    assert better == pytest.approx(2, abs=0.03)
    assert errors[0] > 10 * smaller[0]


@pytest.mark.parametrize(("step", "order"), [("implicit_euler", 1), ("heun", 2), ("bilinear", 2)])
def test_10_is_of_order_1_and_11_of_order_2_solved_or_predicted(step, order):
    def run(f, t, u):
        return streaming.run(getattr(streaming, step), f, t, u, np.zeros(3))

    assert order_of(run, MOVING, (400, 800, 1600))[0] == pytest.approx(order, abs=0.03)


def held_order(step):
    errors, steps = [], np.array([100, 200, 400])
    truth = odometry.se2_exp([6.0, 0.0, 4.0])
    for n in steps:
        end = printed.roll_out(step, np.zeros(3), np.full(n, 1.5), np.ones(n), T=4 / n)[-1]
        errors.append(np.hypot(*(end - truth)[:2]))
    return odometry.order(4 / steps, errors), errors


def held_error(method, n=100):
    end = odometry.integrate(np.zeros(3), np.full(n, 1.5), np.ones(n), 4 / n, method)[-1]
    return np.hypot(*(end - odometry.se2_exp([6.0, 0.0, 4.0]))[:2])


def test_41_with_the_heading_of_the_end_is_of_order_1_still():
    order, errors = held_order(printed.step_41)
    assert order == pytest.approx(1, abs=0.01)
    assert errors[0] == pytest.approx(held_error("euler"), rel=0.03)


def test_42_is_of_order_1_with_twice_the_error_of_euler():
    order, errors = held_order(printed.step_42)
    assert order == pytest.approx(1, abs=0.01)
    assert errors[0] == pytest.approx(2 * held_error("euler"), rel=0.03)
    assert errors[0] > 300 * held_error("midpoint")


def test_43_does_not_converge_because_cos_and_sin_are_changed_over():
    order, errors = held_order(printed.step_43)
    assert abs(order) < 1e-9 and errors[0] > 1
    pose = printed.step_43([0, 0, 0.3], 1.5, 0.8, 0.5)
    right = odometry.integrate([0, 0, 0.3], [1.5], [0.8], 0.5, "exact")[1]
    np.testing.assert_allclose(pose[[1, 0]] * [-1, 1], right[:2] * [1, -1], atol=1e-14)


def test_algorithm_1_of_mastalli_is_metres_off_on_a_path_of_67_s_where_the_arc_is_exact():
    v, omega = quasi_rectangle()
    truth = odometry.integrate(np.zeros(3), v, omega, 0.01, "exact")
    assert len(v) * 0.01 == pytest.approx(67, abs=0.05)
    np.testing.assert_allclose(truth[-1, :2], 0, atol=1e-9)
    assert rmse(mastalli(v, omega), truth) > 1


def test_with_noisy_encoders_algorithm_1_of_mastalli_is_8_m_off_and_the_arc_decimetres():
    v, omega = quasi_rectangle()
    truth = odometry.integrate(np.zeros(3), v, omega, 0.01)
    rng, noise = np.random.default_rng(0), np.sqrt(0.02)
    left, right = (
        (v + side * omega * GAUGE / 2) / RADIUS + noise * rng.normal(size=len(v))
        for side in (-1, 1)
    )
    measured = tracks_twist(left, right)
    assert rmse(mastalli(*measured), truth) == pytest.approx(8, abs=1)
    assert rmse(odometry.integrate(np.zeros(3), *measured, 0.01), truth) < 0.3


def test_algorithm_1_of_mastalli_takes_every_turn_to_the_right_for_a_straight():
    v, omega = quasi_rectangle()
    expected = printed.roll_out(printed.step_42, np.zeros(3), v, -omega, T=0.01)
    np.testing.assert_allclose(mastalli(v, -omega), expected, atol=1e-12)


def test_algorithm_1_corrected_needs_no_threshold():
    """Straights, arcs both ways and turns below 0.001 rad/s, against the poses of a DOP853 run."""
    from scipy.integrate import solve_ivp

    v, omega = np.array([0.5, 0.5, 0.4, -0.3]), np.array([0.0, 0.3, -0.4, 9e-4])
    left, right = (v - omega * GAUGE / 2) / RADIUS, (v + omega * GAUGE / 2) / RADIUS
    distance, turn = tracks_twist(2.0 * left, 2.0 * right)
    poses = odometry.integrate(np.zeros(3), distance, turn, 1.0)
    pose = np.zeros(3)
    for k in range(4):

        def rate(_, q, k=k):
            return [v[k] * np.cos(q[2]), v[k] * np.sin(q[2]), omega[k]]

        pose = solve_ivp(rate, (0, 2), pose, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        np.testing.assert_allclose(poses[k + 1], pose, atol=1e-10)
