"""Estimators that run sample by sample."""

import numpy as np
import pytest

from backhoe.localisation import odometry
from backhoe.localisation.odometry import streaming

ROBOT = odometry.differential(0.35, 2.0)
MOTION = odometry.winding()


def estimate(step, t, v, omega):
    u = ROBOT.wheel_speeds(np.stack([v, 0 * v, omega], axis=-1))
    return streaming.run(step, ROBOT.rate, t, u, np.zeros(3))


@pytest.mark.parametrize(
    ("step", "order"), [("euler", 1), ("implicit_euler", 1), ("heun", 2), ("bilinear", 2)]
)
def test_order_of_each_step(step, order):
    def end(t, v, omega):
        return estimate(getattr(streaming, step), t, v, omega)

    steps, errors = odometry.final_errors(end, (400, 800, 1600))
    assert odometry.order(steps, errors) == pytest.approx(order, abs=0.03)


@pytest.mark.parametrize("step", ["implicit_euler", "bilinear"])
def test_the_fixed_point_solves_the_implicit_equation(step):
    rng = np.random.default_rng(1)
    old, u = rng.normal(size=(2, 2))
    state = streaming.State(1.0, rng.normal(size=3), old)
    new = getattr(streaming, step)(state, 1.3, u, ROBOT.rate)
    rate = ROBOT.rate(new.x, u)
    if step == "bilinear":
        rate = (rate + ROBOT.rate(state.x, old)) / 2
    np.testing.assert_allclose(new.x, state.x + 0.3 * rate, atol=1e-11)
    assert new.t == 1.3 and (new.u == u).all()


def test_on_a_vehicle_the_fixed_point_is_there_after_two_repetitions():
    calls = []

    def rate(x, u):
        calls.append(x)
        return ROBOT.rate(x, u)

    streaming.implicit_euler(streaming.State(0.0, np.zeros(3), np.zeros(2)), 0.1, [1, 2], rate)
    assert len(calls) == 3


@pytest.mark.parametrize(
    ("step", "rule"), [("euler", "right"), ("heun", "trapezoid"), ("bilinear", "trapezoid")]
)
def test_with_a_constant_jacobian_the_steps_are_the_linear_sums(step, rule):
    rng = np.random.default_rng(2)
    J, t, u = (
        rng.normal(size=(3, 4)),
        np.cumsum(rng.uniform(0.01, 0.3, 30)),
        rng.normal(size=(30, 4)),
    )
    found = streaming.run(getattr(streaming, step), streaming.linear(J), t, u, np.ones(3))
    dt, held = odometry.intervals(t, u.T, rule)
    expected = 1 + np.cumsum(J @ (held * dt), axis=1)
    np.testing.assert_allclose(found[1:], expected.T, atol=1e-12)


def test_the_first_sample_moves_nothing_and_times_may_start_anywhere():
    t = MOTION.instants(50)
    v, omega = MOTION.v(t), MOTION.omega(t)
    early, late = (estimate(streaming.heun, t + offset, v, omega) for offset in (0.0, 1e4))
    assert (early[0] == 0).all()
    np.testing.assert_allclose(late, early, atol=1e-8)


def test_an_omnidirectional_robot_runs_through_the_same_steps():
    robot = odometry.omni(0.05, 0.2)
    velocity = np.tile([0.3, -0.2, 0.5], (201, 1))
    t = np.linspace(0, 4, 201)
    found = streaming.run(streaming.heun, robot.rate, t, robot.wheel_speeds(velocity), np.zeros(3))
    np.testing.assert_allclose(found[-1], odometry.se2_exp(4 * velocity[0]), atol=2e-5)


def test_a_step_too_long_for_the_fixed_point_says_so():
    state = streaming.State(0.0, np.ones(1), np.zeros(1))
    for step in (streaming.implicit_euler, streaming.bilinear):
        with pytest.raises(ArithmeticError, match=r"did not settle in 50 .*sample faster"):
            step(state, 1.0, [0.0], lambda x, u: -30 * x)


def test_bad_samples_are_named():
    f, state = ROBOT.rate, streaming.State(1.0, np.zeros(3), np.zeros(2))
    with pytest.raises(ValueError, match=r"at 1.0 s cannot follow one at 1.0 s"):
        streaming.euler(state, 1.0, [0, 0], f)
    with pytest.raises(ValueError, match="times must rise"):
        streaming.heun(state, np.nan, [0, 0], f)
    with pytest.raises(ValueError, match=r"as the sample before, \(2,\), got \(3,\)"):
        streaming.bilinear(state, 2.0, [0, 0, 0], f)
    with pytest.raises(ValueError, match="u must be finite"):
        streaming.euler(state, 2.0, [0, np.nan], f)


def test_run_refuses_shapes_that_do_not_fit():
    f, t = ROBOT.rate, [0.0, 1.0]
    with pytest.raises(ValueError, match=r"u must be a sample for each time, shape \(2, m\)"):
        streaming.run(streaming.euler, f, t, np.zeros((3, 2)), np.zeros(3))
    with pytest.raises(ValueError, match=r"x0 must have shape \(n,\)"):
        streaming.run(streaming.euler, f, t, np.zeros((2, 2)), 0.0)
    with pytest.raises(ValueError, match=r"f must give \(4,\)"):
        streaming.run(streaming.euler, lambda x, u: x[:3], t, np.zeros((2, 2)), np.zeros(4))
    with pytest.raises(ValueError, match=r"J must have shape \(n, m\)"):
        streaming.linear([1, 2])
