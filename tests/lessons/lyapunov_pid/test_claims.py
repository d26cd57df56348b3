"""What lesson 03 says in words, where no other test does."""

import numpy as np
import pytest

from backhoe.arm import closed_loop, dynamics, lyapunov, movement
from backhoe.arm.lyapunov import State
from backhoe.arm.pid import DigitalPID, Gains
from backhoe.lessons import published
from backhoe.lessons.dynamics import printed as printed_model
from backhoe.machine import BACKHOE

NUMBERS = published.load("mastalli_2013_arm_constants")
TABLES = (published.load(f"mastalli_2013_{name}") for name in ("eq_333", "table_31"))
PRINTINGS = [Gains(*(np.array(t[gain]) for gain in ("K_p", "K_i", "K_d"))) for t in TABLES]
GAINS = PRINTINGS[0]
TORQUE_AT = np.array([0.05, 0.1, 0.1, 0.1])  # error at which a spring fills its drive [rad]


@pytest.fixture
def rng():
    return np.random.default_rng(71)


@pytest.fixture(scope="module")
def tuned():
    kp = BACKHOE.torque_limit / TORQUE_AT
    return lyapunov.tune("matrix", kp=kp, ki=0.4 * (kp - lyapunov.constants().kg), error=0.5)


@pytest.fixture(scope="module")
def loading():
    return movement.loading()


def in_box(rng, count):
    return rng.uniform(BACKHOE.lower, BACKHOE.upper, (count, 4))


def everywhere(rng, count):
    return rng.uniform(-np.pi, np.pi, (count, 4))


# sections 2 to 5


def test_a_house_that_spins_evenly_needs_one_torque_and_a_boom_does_not(rng):
    q, still = in_box(rng, 50), np.zeros(4)
    for joint, constant in ((0, True), (1, False)):
        turn, speed = np.linspace(0, 1, 11)[:, None] * np.eye(4)[joint], 0.5 * np.eye(4)[joint]
        needed = np.array([dynamics.inverse_dynamics(q + x, speed, still) for x in turn])
        assert (np.ptp(needed, axis=0).max() < 1e-6) == constant


def test_where_v_does_not_fall_only_the_goal_is_at_rest(rng):
    w, still = rng.normal(size=(500, 4)), np.zeros((500, 4))
    state = State(w, still, still, in_box(rng, 500))
    np.testing.assert_array_equal(lyapunov.derivative(state, GAINS, 1.5), 0.0)
    *_, ddq = lyapunov.closed_loop_rate(state, GAINS, 1.5)
    assert (np.linalg.norm(ddq, axis=-1) > 0.01 * np.linalg.norm(w, axis=-1)).all()


def test_an_arm_whose_error_is_inside_can_leave_on_its_way(tuned):
    region, alpha, goal = tuned.certificate.region, tuned.alpha, np.radians([0, 20, -20, 60])
    x = np.array([np.zeros(4), 0.99 * region * np.eye(4)[0], -2.0 * np.eye(4)[0]])
    slope = lyapunov.derivative(State(*x, goal), tuned.gains, alpha)
    for _ in range(100):
        rates = lyapunov.closed_loop_rate(State(*x, goal), tuned.gains, alpha)
        x = x + 1e-3 * np.array(rates)
    assert slope < 0 and np.linalg.norm(x[1]) > region


# section 6


def test_the_printed_model_has_the_printed_ratio_in_no_posture(rng):
    """lambda_max >= M11 and lambda_min <= M44, whatever the rest of M."""
    M = printed_model.mass_matrix(everywhere(rng, 20_000))
    assert M[:, 0, 0].min() >= 23_387
    assert np.allclose(M[:, 3, 3], 501, atol=0.5)
    assert 23_387**2 / 501.5 > 1.08e6 > 6 * NUMBERS["inertia"]["local_ratio"]


def test_of_the_printed_constants_kc1_alone_is_above_the_smallest_that_holds():
    sharp, recipe = lyapunov.constants(), lyapunov.constants(recipe="printed")
    gravity, coriolis = NUMBERS["gravity"], NUMBERS["coriolis"]
    assert sharp.kc1 < coriolis["k_C1"] < recipe.kc1 / 7
    assert gravity["k_g"] < sharp.kg and gravity["largest_slope"] < sharp.largest_slope
    assert coriolis["largest_symbol"] < sharp.largest_symbol
    assert NUMBERS["inertia"]["local_ratio"] < sharp.ratio


def test_with_the_recipe_for_kg_no_route_that_uses_it_certifies_333():
    recipe = lyapunov.constants(recipe="printed")
    for route in ("scalar", "matrix"):
        judged = lyapunov.check_gains(GAINS, constants=recipe, route=route)
        assert not judged.holds and judged.alpha_low == np.inf
    assert lyapunov.check_gains(GAINS, route="matrix").holds


# sections 8 and 9


def test_at_1_khz_both_printings_run_away_in_a_third_of_the_postures(rng):
    q = in_box(rng, 4000)
    for gains in PRINTINGS:
        assert (lyapunov.sampled_radius(gains, q) > 1).mean() == pytest.approx(1 / 3, abs=0.03)


def test_at_100_hz_the_dampers_of_333_overdamp_in_every_posture(rng):
    """The fastest rate is at least K_d4 / M44, by the quotient of Rayleigh."""
    M = dynamics.mass_matrix(everywhere(rng, 5000))
    least = GAINS.kd[3] / M[:, 3, 3]
    fastest = np.linalg.eigvals(np.linalg.solve(M, np.diag(GAINS.kd))).real.max(axis=-1)
    assert np.ptp(M[:, 3, 3]) < 1e-9 and least[0] == pytest.approx(728, abs=1)
    assert (fastest >= least).all() and least[0] * 0.01 > 2


def test_the_tuned_bucket_is_damped_too_fast_for_100_hz_in_half_of_the_postures(rng, tuned):
    radius = lyapunov.sampled_radius(tuned.gains, in_box(rng, 4000), dt=0.01)
    assert (radius > 1).mean() == pytest.approx(0.5, abs=0.03)


def test_the_backward_filter_does_not_ring_and_tustins_does_below_half_a_sample():
    for time in np.geomspace(1e-5, 10, 25):
        for form in ("backward", "tustin"):
            pid = DigitalPID(0.0, 0.0, 1.0, 0.01, filter_time=time, form=form)
            pid(0.0, 0.0)
            first, second = pid(0.0, -1.0), pid(0.0, -1.0)
            assert (second / first < 0) == (form == "tustin" and time < 0.005)


# sections 10 and 11


def test_without_limits_the_loading_movement_with_333_runs_away_in_its_first_second(loading):
    run = closed_loop.simulate(GAINS, loading, settled=True)
    assert run.diverged[0] and run.stopped_at[0] < 1


def test_with_333_computed_fast_enough_the_boom_alone_leaves_the_band_of_fig_310():
    run = closed_loop.simulate(GAINS, movement.loading(dt=2e-4), settled=True)
    worst = np.degrees(run.peak_error[0])
    assert worst[1] == pytest.approx(2.1, abs=0.05)
    assert (worst[[0, 2, 3]] < 2).all()
    assert run.overrun.max() == 0


def test_with_a_load_every_law_holds_every_joint_worse(loading, tuned):
    unit = Gains([100.0] * 4, [100.0] * 4, [20.0] * 4)
    laws = {"pid": tuned.gains, "pid+gravity": tuned.gains, "computed_torque": unit}
    for law, gains in laws.items():
        runs = [
            closed_loop.simulate(gains, loading, law=law, payload=load, settled=True)
            for load in (0.0, 1000.0, 2000.0)
        ]
        assert (np.diff([run.rms_error[0] for run in runs], axis=0) > 0).all()


def test_without_friction_computed_torque_has_no_error_to_speak_of(loading):
    unit = Gains([100.0] * 4, [100.0] * 4, [20.0] * 4)
    run = closed_loop.simulate(unit, loading, law="computed_torque", settled=True, friction=False)
    assert np.degrees(run.rms_error).max() < 0.01


def test_with_a_lazy_integral_every_run_below_the_clocks_line_holds(loading, tuned):
    stiffness, damping = np.geomspace(1 / 16, 4, 10)[::3], np.geomspace(1 / 30, 30, 10)[:8]
    kp = np.repeat(stiffness, 8)[:, None] * tuned.gains.kp
    gains = Gains(kp, kp / 30, np.tile(damping, 4)[:, None] * tuned.gains.kd)
    assert not closed_loop.simulate(gains, loading, settled=True).diverged.any()


def test_where_the_arm_waits_neither_loop_bears_the_delay_that_its_margin_allows(loading, tuned):
    """0.5 of 0.9 ms with the gains of (3.33) at 1 kHz, 5.5 of 9 ms with the tuned at 100 Hz."""
    q_wait = loading.q[5000]
    assert lyapunov.sampled_radius(GAINS, q_wait) > 1.1
    assert lyapunov.sampled_radius(tuned.gains, q_wait, dt=0.01) > 1.1
    assert lyapunov.sampled_radius(tuned.gains, q_wait) < 1


# 03a: the folded algebra


def test_each_line_of_the_folded_algebra_is_the_rate_of_its_piece_of_v(rng):
    """Each piece of V by differences along the motion, against the line that the lesson gives."""
    alpha, (kp, ki, kd), still = 1.5, GAINS, np.zeros(4)

    def pieces(w, e, v, goal):
        q, M = goal - e, dynamics.mass_matrix(goal - e)
        height = dynamics.energy(q, still)[1] - dynamics.energy(goal, still)[1]
        return np.array(
            [
                v @ M @ v / 2,
                -alpha * e @ M @ v,
                alpha / 2 * e @ (kd * e),
                w @ (ki * w) / (2 * alpha),
                e @ ((kp - ki / alpha) * e) / 2,
                height + e @ dynamics.gravity_torque(goal),
            ]
        )

    def lines(w, e, v, goal):
        q = goal - e
        M, C = dynamics.mass_matrix(q), dynamics.coriolis_matrix(q, v)
        lighter = dynamics.gravity_torque(goal) - dynamics.gravity_torque(q)
        S = (kp - ki / alpha) * e + ki * w / alpha + lighter
        return np.array(
            [
                v @ S - v @ (kd * v),
                alpha * (v @ M @ v - e @ C.T @ v - e @ S + e @ (kd * v)),
                -alpha * e @ (kd * v),
                w @ (ki * e) - w @ (ki * v) / alpha,
                -e @ ((kp - ki / alpha) * v),
                -lighter @ v,
            ]
        )

    for goal in in_box(rng, 20):
        w, e, v = rng.uniform(-0.5, 0.5, (3, 4))
        rates = lyapunov.closed_loop_rate(State(w, e, v, goal), GAINS, alpha)
        h = 1e-6
        after, before = (
            pieces(*(x + side * rate for x, rate in zip((w, e, v), rates, strict=True)), goal)
            for side in (h, -h)
        )
        slope, given = (after - before) / (2 * h), lines(w, e, v, goal)
        np.testing.assert_allclose(slope, given, rtol=1e-4, atol=1e-4 * np.abs(given).max())
        total = lyapunov.derivative(State(w, e, v, goal), GAINS, alpha)
        assert given.sum() == pytest.approx(total, rel=1e-9, abs=1e-3)
