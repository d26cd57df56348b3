"""What the thesis prints of its stability analysis, judged by its own definitions."""

import numpy as np
import pytest

from backhoe.arm import dynamics, lyapunov
from backhoe.arm.lyapunov import State
from backhoe.arm.lyapunov.conditions import least
from backhoe.arm.pid import Gains
from backhoe.lessons import published
from backhoe.lessons.lyapunov_pid import inequalities, printed
from backhoe.machine import BACKHOE, replace

EQ_333, TABLE_31 = (published.load(f"mastalli_2013_{name}") for name in ("eq_333", "table_31"))
NUMBERS = published.load("mastalli_2013_arm_constants")
GAINS = Gains(*(np.array(EQ_333[name]) for name in ("K_p", "K_i", "K_d")))
EVEN = Gains(np.full(4, 9e5), np.full(4, 5e4), np.full(4, 1e6))
LOOSE = Gains(np.full(4, 9e5), np.full(4, 5e3), np.full(4, 1e6))
ALPHA, COUNT = 1.5, 10_000


@pytest.fixture
def rng():
    return np.random.default_rng(35)


@pytest.fixture(scope="module")
def exact():
    return lyapunov.constants(domain="torus")


@pytest.fixture
def thesis(exact):
    """The constants with which the thesis worked, as far as it prints them."""
    return exact.replace(kg=NUMBERS["gravity"]["k_g"], kc1=NUMBERS["coriolis"]["k_C1"])


def by_35(state, gains, alpha):
    return printed.closed_loop_rate_35(*state, gains)


def moved(state, rates, t):
    """The state a time t later, along its rates."""
    return State(*(x + t * rate for x, rate in zip(state[:3], rates, strict=True)), state.goal)


def poles(rate, goal):
    """Eigenvalues of the closed loop linearised at rest in the goal, (12,) [1/s]."""
    x = 1e-6 * np.eye(12).reshape(12, 3, 4).transpose(1, 0, 2)
    ahead, behind = (
        np.concatenate(rate(State(*(sign * x), goal), GAINS, ALPHA), axis=-1) for sign in (1, -1)
    )
    return np.linalg.eigvals((ahead - behind).T / 2e-6)


# (3.5), (3.7)


def test_printed_35_and_37_differ_from_the_closed_loop_in_the_damping_alone(rng):
    z, error, dq, goal = rng.normal(size=(4, 50, 4))
    pushed = 2 * np.linalg.solve(dynamics.mass_matrix(goal - error), (GAINS.kd * dq)[..., None])
    pushed = pushed[..., 0]
    state = State(ALPHA * z + error, error, dq, goal)
    right = lyapunov.closed_loop_rate(state, GAINS, ALPHA)
    in_w = printed.closed_loop_rate_37(state, GAINS, ALPHA)
    in_z = printed.closed_loop_rate_35(z, error, dq, goal, GAINS)
    for ours, theirs in zip(right[:2], in_w[:2], strict=True):
        np.testing.assert_allclose(theirs, ours)
    np.testing.assert_array_equal(in_z[0], error)
    for ddq in (in_w[2], in_z[2]):
        np.testing.assert_allclose(ddq - pushed, right[2], rtol=1e-9, atol=1e-8)


def test_printed_35_and_37_run_away_in_every_posture_at_700_to_2500_1_s(rng):
    for goal in rng.uniform(-np.pi, np.pi, (100, 4)):
        fastest = poles(by_35, goal).real.max()
        assert 700 < fastest < 2500
        assert poles(printed.closed_loop_rate_37, goal).real.max() == pytest.approx(fastest)


def test_printed_derivative_of_v_does_not_belong_to_printed_37(rng):
    state, h = State(*rng.normal(size=(4, 300, 4))), 1e-6
    claimed = lyapunov.derivative(state, GAINS, ALPHA)
    rates = printed.closed_loop_rate_37(state, GAINS, ALPHA)
    ahead, behind = (lyapunov.function(moved(state, rates, t), GAINS, ALPHA) for t in (h, -h))
    assert (np.abs((ahead - behind) / (2 * h) - claimed) > 0.1 * np.abs(claimed)).mean() > 0.9


# (3.17)


def test_317_is_enough_for_the_exact_condition_but_loses_the_condition_number(exact):
    high = printed.alpha_high_317(EVEN.kd, exact)
    needed = EVEN.kd.min() / exact.lambda_max
    for alpha, positive in ((high, True), (0.999 * needed, True), (1.001 * needed, False)):
        assert (least(np.diag(EVEN.kd) / alpha, exact.over, BACKHOE) > 0) == positive
    assert needed / high == pytest.approx(exact.lambda_max / exact.lambda_min)
    assert needed / high > 800


def test_the_condition_number_over_all_angles_is_in_the_hundreds(rng):
    ends = np.linalg.eigvalsh(dynamics.mass_matrix(rng.uniform(-np.pi, np.pi, (COUNT, 4))))
    number = ends[:, -1] / ends[:, 0]
    assert number.min() > 100 and number.max() < 860
    assert np.median(number) == pytest.approx(223, abs=10)


# (3.22), (3.24)


def test_printed_322_fails_more_often_the_slower_the_arm_moves(rng, exact):
    goal, error = rng.uniform(-np.pi, np.pi, (COUNT, 4)), rng.normal(size=(COUNT, 4)) / 2
    direction = rng.normal(size=(COUNT, 4))
    shares = []
    for size in (1.0, 0.1, 0.01, 0.001):
        dq = size * direction
        speed, far = np.linalg.norm(dq, axis=-1), np.linalg.norm(error, axis=-1)
        turning = lyapunov.derivative_terms(State(error, error, dq, goal), EVEN, ALPHA)[:, 2]
        shares.append((turning > ALPHA * exact.kc1 * speed * speed**2).mean())
        assert (turning <= ALPHA * exact.kc1 * far * speed**2).all()
    assert shares == sorted(shares)
    assert shares[0] < 0.01 and shares[-1] > 0.4


def test_the_right_side_of_324_is_the_region_of_the_position_error(exact):
    certificate = lyapunov.check_gains(LOOSE, constants=exact)
    assert certificate.holds
    assert printed.bound_324(LOOSE, exact) == pytest.approx(certificate.region)
    _, edge = inequalities.rate_weights(
        [certificate.region, 0, 0, 0], LOOSE, certificate.alpha_low, exact
    )
    assert edge == pytest.approx(0.0, abs=1e-6 * LOOSE.kd[0])


def test_324_counts_no_seconds():
    """A slower clock leaves a bound on a speed smaller, but not the right side of (3.24)."""
    slow = 10.0  # new seconds are ten old ones: torques 100, K_d 10, K_i 1000 times as large
    once, later = (
        lyapunov.constants(domain="torus", machine=machine)
        for machine in (BACKHOE, replace(BACKHOE, gravity=BACKHOE.gravity * slow**2))
    )
    here = printed.bound_324(LOOSE, once)
    kp, ki, kd = LOOSE
    there = printed.bound_324(Gains(kp * slow**2, ki * slow**3, kd * slow), later)
    assert there == pytest.approx(here)


# (3.31) to (3.34)


def test_the_printed_constants_are_their_recipes(thesis):
    gravity, coriolis, n = NUMBERS["gravity"], NUMBERS["coriolis"], NUMBERS["n"]
    assert gravity["k_g"] == n * gravity["largest_slope"]
    assert coriolis["k_C1"] == pytest.approx(n**2 * coriolis["largest_symbol"])
    assert NUMBERS["conclusions"]["K_p_above"] == gravity["k_g"]


def test_the_printed_slope_of_gravity_is_below_that_of_almost_all_postures(rng):
    q = rng.uniform(BACKHOE.lower, BACKHOE.upper, (COUNT, 4))
    slope = lyapunov.profile(q[:2000]).slope
    assert (slope < NUMBERS["gravity"]["largest_slope"]).mean() < 0.005
    assert np.median(slope) > 5 * NUMBERS["gravity"]["largest_slope"]


def test_the_printed_ratio_is_impossible_for_any_posture(rng):
    profile = lyapunov.profile(rng.uniform(-np.pi, np.pi, (2000, 4)))
    assert profile.ratio.min() > 40 * NUMBERS["inertia"]["local_ratio"]
    swing, boom, stick, bucket = BACKHOE.swing, *BACKHOE.links
    yaw = swing.inertia + boom.inertia + stick.inertia + swing.mass * swing.com_radius**2
    tip = bucket.mass * bucket.com_radius**2 + bucket.inertia
    assert yaw**2 / tip > 6 * NUMBERS["inertia"]["local_ratio"]


def test_the_printed_bound_on_kd_needs_a_ratio_that_is_impossible_too(thesis):
    wanted = NUMBERS["conclusions"]["K_d_above"]
    needed = wanted / printed.kd_bound_334(GAINS.kp, GAINS.ki, thesis.replace(ratio=1.0))
    assert needed == pytest.approx(175790, abs=5)
    assert needed == pytest.approx(NUMBERS["inertia"]["local_ratio"], rel=0.08)
    assert thesis.ratio > 600 * needed


def test_with_the_exact_constants_the_bound_on_kd_is_a_thousand_times_as_large(exact):
    bound = printed.kd_bound_334(GAINS.kp, GAINS.ki, exact)
    assert bound == pytest.approx(3.54e8, rel=1e-2)
    assert bound > 1000 * NUMBERS["conclusions"]["K_d_above"]


def test_the_two_printings_of_the_gains_differ_in_two_entries():
    differences = [
        (name, j)
        for name in ("K_p", "K_d", "K_i")
        for j in range(4)
        if EQ_333[name][j] != TABLE_31[name][j]
    ]
    assert differences == [("K_d", 0), ("K_i", 3)]
    assert EQ_333["K_d"][0] == 10 * TABLE_31["K_d"][0]


def test_the_printed_speed_bound_is_ten_times_what_its_formula_can_give(thesis):
    at_most = np.degrees(printed.bound_324(GAINS, thesis.replace(lambda_max=0.0)))
    printed_bound = NUMBERS["conclusions"]["speed_bound_deg"]
    assert at_most == pytest.approx(115.4, abs=0.1)
    assert printed_bound / at_most == pytest.approx(10, rel=0.01)
    own = np.degrees(printed.bound_324(GAINS, thesis))
    assert own == pytest.approx(46.4, abs=0.1)
    assert own < NUMBERS["movement"]["largest_speed_deg"]


# (A.8)


def test_printed_a8_never_holds_and_its_reverse_always(rng, exact):
    q, x, y = rng.uniform(-np.pi, np.pi, (3, COUNT, 4))
    for recipe in ("tight", "printed"):
        c = lyapunov.constants(domain="torus", recipe=recipe)
        assert not printed.coriolis_bound_a8(q, x, y, c).any()


def test_bad_states_and_gains_are_refused(exact):
    zero = np.zeros(4)
    with pytest.raises(ValueError, match="dq must end in 4 joints"):
        printed.weight_322(State(zero, zero, zero[:3], zero), GAINS, ALPHA, exact)
    with pytest.raises(ValueError, match="K_d must be positive definite"):
        printed.closed_loop_rate_35(*[zero] * 4, GAINS._replace(kd=-GAINS.kd))
    with pytest.raises(ValueError, match="alpha must be one number above 0"):
        printed.closed_loop_rate_37(State(*[zero] * 4), GAINS, 0.0)
