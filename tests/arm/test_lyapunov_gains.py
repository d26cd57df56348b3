"""Certificates, the region of attraction, sampling and tuning."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import minimize

from backhoe.arm import dynamics, lyapunov
from backhoe.arm.integrate import rk4
from backhoe.arm.lyapunov import State
from backhoe.arm.lyapunov.conditions import damping_per_alpha, route_named
from backhoe.arm.lyapunov.conditions import least as least_over
from backhoe.arm.lyapunov.suprema import domain_of
from backhoe.arm.pid import Gains
from backhoe.lessons import published
from backhoe.machine import BACKHOE, replace
from backhoe.machine.variants import loaded

ROUTES = ("scalar", "matrix", "exact")
PRINTINGS = {
    name: Gains(
        *(np.array(published.load(f"mastalli_2013_{name}")[gain]) for gain in ("K_p", "K_i", "K_d"))
    )
    for name in ("eq_333", "table_31")
}
GOAL = np.array([0.4, 0.2, 0.0, 0.7])


@pytest.fixture
def rng():
    return np.random.default_rng(34)


@pytest.fixture(scope="module")
def box():
    return lyapunov.constants()


@pytest.fixture(scope="module")
def torus():
    return lyapunov.constants(domain="torus")


@pytest.fixture(scope="module")
def tunings():
    return {route: lyapunov.tune(route) for route in ROUTES}


def in_box(rng, count):
    return rng.uniform(BACKHOE.lower, BACKHOE.upper, (count, 4))


def least(A):
    return np.linalg.eigvalsh(A)[..., 0]


# the exact condition


def test_the_schur_complement_decides_whether_the_form_of_v_is_positive(rng):
    q, alpha = in_box(rng, 2000), 1.3
    scale = np.exp(rng.uniform(np.log(0.2), np.log(3), 2000))
    verdicts = []
    for posture, size in zip(q, scale, strict=True):
        M = dynamics.mass_matrix(posture)
        axes = rng.normal(size=(4, 4))
        Kd = size * alpha * (0.9 * M + 0.02 * axes @ axes.T * np.trace(M))
        Kd = (Kd + Kd.T) / 2
        whole = np.block([[alpha * Kd, -alpha * M], [-alpha * M, M]])
        verdicts.append((least(whole) > 0, least(Kd - alpha * M) > 0))
    whole, complement = np.array(verdicts).T
    np.testing.assert_array_equal(whole, complement)
    assert 0.2 < whole.mean() < 0.8


def test_the_exact_condition_over_a_domain_is_its_least_over_postures(rng, box, torus):
    kd, q = np.diag([4e5, 6e5, 1e5, 2e4]), in_box(rng, 20_000)
    over_box, over_torus = (2.0 * least_over(kd / 2.0, c.over, BACKHOE) for c in (box, torus))
    somewhere = least(kd - 2.0 * dynamics.mass_matrix(q))
    assert over_torus < over_box <= somewhere.min()
    assert somewhere.min() < over_box + 0.03 * abs(over_box)


# routes


def test_each_route_implies_the_next(rng, box):
    held = np.zeros(3, dtype=int)
    sizes = [(1e6, 1e6, 2e2), (1e6, 1e6, 2e5), (1e6, 1e6, 3e6), (3e5, 1e5, 1e4), (3e5, 5e4, 2e5)]
    for size in sizes * 2:
        kp, kd, ki = np.array(size)[:, None] * rng.uniform(0.8, 1.25, (3, 4))
        found = [
            lyapunov.check_gains(Gains(kp, ki, kd), constants=box, route=route, error=0.5)
            for route in ROUTES
        ]
        lows, highs = [c.alpha_low for c in found], [c.alpha_high for c in found]
        regions, verdicts = [c.region for c in found], [c.holds for c in found]
        for coarse, fine in ((0, 1), (1, 2)):
            assert lows[fine] <= lows[coarse] * (1 + 1e-9)
            assert highs[fine] >= highs[coarse] * (1 - 1e-9)
            assert regions[fine] >= regions[coarse] * (1 - 1e-6)
        assert verdicts == sorted(verdicts)
        held += verdicts
    assert 0 < held[0] < held[1] <= held[2] < len(sizes) * 2


@pytest.mark.parametrize("route", ROUTES)
def test_the_region_is_where_the_bound_on_alpha_is_reached(route, box):
    gains = Gains(*map(np.diag, PRINTINGS["eq_333"]))
    judge, alpha = route_named(route), 1.5
    region = judge.region(gains, box, alpha)
    assert judge.alpha_decay(gains, box, region) == pytest.approx(alpha, rel=1e-5)


@pytest.mark.parametrize("route", ROUTES)
def test_inside_the_region_v_falls_whatever_the_state(route, rng, tunings):
    tuning = tunings[route]
    region = min(tuning.certificate.region, np.pi / 2)
    q, goal = in_box(rng, 20_000), in_box(rng, 20_000)
    error = goal - q
    kept = np.linalg.norm(error, axis=-1) < region
    dq = rng.normal(size=(20_000, 4)) * 10 ** rng.uniform(-2, 2, (20_000, 1))
    state = State(np.zeros(4), error[kept], dq[kept], goal[kept])
    slope = lyapunov.derivative(state, tuning.gains, tuning.alpha)
    assert kept.sum() > 500
    assert (slope < 0).all()


def test_beyond_the_exact_region_v_can_rise(rng, box):
    gains = PRINTINGS["table_31"]
    certificate = lyapunov.check_gains(gains, constants=box, route="exact", alpha=0.94)
    assert 0.05 < certificate.region < 1
    worst = np.inf
    for q in in_box(rng, 4000):
        M, dM = dynamics.mass_matrix(q), dynamics.mass_matrix_derivative(q)
        x = np.eye(4)[0]
        turn = np.einsum("i,kij,j->k", x, dM, x)
        error = -1.3 * certificate.region * turn / np.linalg.norm(turn)
        left = np.diag(gains.kd) - 0.94 * M + 0.47 * np.einsum("k,kij->ij", error, dM)
        worst = min(worst, least(left))
    assert worst < 0


def test_the_damping_per_alpha_is_reached_by_some_error_and_exceeded_by_none(rng, box):
    weights, radius = np.diag([1.3e5, 8e4, 5e3, 1e3]), 0.8
    bound = damping_per_alpha(weights, radius, box.over, BACKHOE)
    q, error = in_box(rng, 40_000), rng.normal(size=(40_000, 4))
    error *= radius / np.linalg.norm(error, axis=-1, keepdims=True)
    D = np.einsum("nk,nkij->nij", error, dynamics.mass_matrix_derivative(q))
    W = np.diag(1 / np.sqrt(np.diag(weights)))
    sizes = np.linalg.eigvalsh(W @ (dynamics.mass_matrix(q) - D / 2) @ W)[:, -1]
    assert 0.85 * bound < sizes.max() <= bound


def test_the_exact_lower_end_of_alpha_keeps_the_stiffness_positive_everywhere(rng, box):
    kp, ki, _ = gains = PRINTINGS["eq_333"]
    low = lyapunov.check_gains(gains, constants=box, route="exact").alpha_low
    slope = lyapunov.gravity_slope(in_box(rng, 20_000))
    assert least(np.diag(kp - ki / (1.001 * low)) + slope).min() > 0
    edge = lyapunov.gravity_slope(BACKHOE.upper)
    worst = min(least(np.diag(kp - ki / (0.95 * low)) + slope).min(), least(edge).min())
    assert worst < 0


# the thesis's gains


@pytest.mark.parametrize("name", PRINTINGS)
@pytest.mark.parametrize("domain", ["box", "torus"])
def test_the_thesis_gains_fail_its_own_conditions_by_a_factor_of_hundreds(name, domain):
    c = lyapunov.constants(domain=domain)
    certificate = lyapunov.check_gains(PRINTINGS[name], constants=c)
    (failed,) = certificate.failed
    assert failed.equation == "(3.30)"
    assert failed.right / failed.left > 800
    with pytest.raises(ValueError, match=r"lambda_min\(K_d\).* must be > 3\.\d+e\+08 N m s/rad"):
        certificate.require()


def test_the_thesis_gains_of_eq_333_pass_the_exact_conditions(torus):
    certificate = lyapunov.check_gains(PRINTINGS["eq_333"], constants=torus, route="exact")
    assert certificate.require() is certificate
    assert certificate.alpha_low == pytest.approx(0.9424, abs=1e-4)
    assert certificate.alpha_high == pytest.approx(8.038, abs=1e-3)


def test_the_thesis_gains_of_table_31_pass_the_exact_conditions_barely_and_no_other(torus):
    gains = PRINTINGS["table_31"]
    exact = lyapunov.check_gains(gains, constants=torus, route="exact")
    assert exact.holds
    assert (exact.alpha_low, exact.alpha_high) == pytest.approx((0.9424, 0.9446), abs=1e-4)
    matrix = lyapunov.check_gains(gains, constants=torus, route="matrix")
    assert not matrix.holds
    assert matrix.alpha_low > matrix.alpha_high


@pytest.mark.parametrize("name", PRINTINGS)
def test_the_thesis_gains_cannot_be_sampled_at_1_khz(name, rng):
    gains = PRINTINGS[name]
    limit = 2 * lyapunov.effective_inertia() / 0.001
    assert gains.kd[3] > limit[3]
    radius = lyapunov.sampled_radius(gains, in_box(rng, 3000))
    assert 0.2 < (radius > 1).mean() < 0.5
    assert (lyapunov.sampled_radius(gains, in_box(rng, 500), dt=0.0002) < 1).all()


# certificates


def test_alpha_can_be_asked_for(box):
    gains = PRINTINGS["eq_333"]
    free = lyapunov.check_gains(gains, constants=box, route="matrix", error=0.3)
    inside = 0.5 * (free.alpha_low + free.alpha_high)
    chosen = lyapunov.check_gains(gains, constants=box, route="matrix", error=0.3, alpha=inside)
    assert free.holds and chosen.holds
    assert chosen.alpha == inside
    assert 0.3 < chosen.region < free.region
    for wrong, equation in ((0.9 * free.alpha_low, "(3.13)"), (9.0, "(3.17)")):
        failed = lyapunov.check_gains(gains, constants=box, route="matrix", alpha=wrong).failed
        assert [condition.equation for condition in failed] == [equation]


def test_an_error_too_large_is_named_with_what_is_left(box):
    gains = PRINTINGS["eq_333"]
    certificate = lyapunov.check_gains(gains, constants=box, route="matrix", error=9.0)
    (failed,) = certificate.failed
    assert (failed.right, failed.unit) == (9.0, "rad")
    assert failed.left == certificate.region
    assert certificate.alpha_low > certificate.alpha_high


def test_stiffness_below_gravity_leaves_nothing(box):
    for route in ROUTES:
        certificate = lyapunov.check_gains(
            Gains([1e4] * 4, [10.0] * 4, [1e6] * 4), constants=box, route=route, error=0.1
        )
        assert [c.holds for c in certificate.conditions] == [True, False, False, False]
        assert certificate.alpha_low == np.inf
        assert certificate.region == 0.0
        assert "FAILS" in certificate.table()


def test_the_table_says_everything(box):
    table = lyapunov.check_gains(PRINTINGS["eq_333"], constants=box, error=0.1).table()
    assert table.startswith("scalar conditions, constants tight over the joint box")
    assert table.count("holds") == 2 and table.count("FAILS") == 2
    assert "N m s/rad" in table and "alpha: none" in table
    assert all(len(line) == len(line.rstrip()) for line in table.splitlines())


def test_constants_of_a_movement_are_named_as_no_proof(rng):
    c = lyapunov.constants(in_box(rng, 40))
    for route in ROUTES:
        certificate = lyapunov.check_gains(
            PRINTINGS["table_31"], constants=c, route=route, error=1.0
        )
        assert "40 given postures (nothing is proved between them)" in certificate.table()


def test_a_full_bucket_narrows_the_room_for_alpha(box):
    full = lyapunov.constants(machine=loaded(1000.0))
    for route in ("matrix", "exact"):
        here, there = (
            lyapunov.check_gains(PRINTINGS["eq_333"], constants=c, route=route) for c in (box, full)
        )
        assert there.alpha_low > here.alpha_low
        assert there.alpha_high < here.alpha_high


def test_single_joints_count_by_themselves_in_the_matrix_route(box):
    gains = Gains(kp=(1e6, 1e6, 1e6, 3e5), ki=(2e5, 2e5, 2e5, 1e4), kd=(1e6, 1e6, 1e5, 2e4))
    scalar, matrix = (
        lyapunov.check_gains(gains, constants=box, route=route) for route in ROUTES[:2]
    )
    assert scalar.alpha_low == pytest.approx(2e5 / (3e5 - box.kg))
    assert matrix.alpha_low == pytest.approx(2e5 / (1e6 - box.kg))
    assert matrix.holds and not scalar.holds


# region of attraction


@pytest.fixture(scope="module")
def attraction(tunings):
    return lyapunov.attraction(GOAL, tunings["matrix"].gains)


def unit(rng, count):
    x = rng.normal(size=(count, 4))
    return x / np.linalg.norm(x, axis=-1, keepdims=True)


def test_on_the_edge_of_the_ball_v_is_at_least_the_level(attraction, rng):
    error = attraction.radius * unit(rng, 4000)
    M = dynamics.mass_matrix(GOAL - error)
    gains, alpha = Gains(*map(np.diag, attraction.gains)), attraction.alpha
    lowest = lyapunov.function(State(np.zeros(4), error, alpha * error, GOAL), gains, alpha)
    assert (lowest >= attraction.level).all()
    for _ in range(3):  # the speed that makes V least is alpha times the error, whatever M
        dq = alpha * error + 0.1 * rng.normal(size=error.shape)
        V = lyapunov.function(State(np.zeros(4), error, dq, GOAL), gains, alpha)
        np.testing.assert_array_less(lowest, V)
    assert M.shape == (4000, 4, 4)


@pytest.mark.parametrize("counts, most", [("integral", 1.4), ("inertia", 8.0), ("gravity", 1.2)])
def test_the_least_v_on_the_edge_of_the_region_is_above_its_level(counts, most, box, rng):
    """It is searched over the edge. In the lesson's loop K_i/alpha counts for much; with equal
    gains the arm's inertia does where alpha is near its upper end, and gravity where it pulls the
    goal down and alpha is near its lower end."""
    goal = np.radians([0.0, 20.0, -20.0, 60.0])
    gains, alpha = (
        Gains(*(np.full(4, gain) for gain in (1.2 * box.kg, 1e4, 3 * box.lambda_max))),
        None,
    )
    if counts == "integral":
        spring = BACKHOE.torque_limit / np.array([0.05, 0.1, 0.1, 0.1])
        gains = lyapunov.tune("matrix", kp=spring, ki=0.4 * (spring - box.kg), error=0.5).gains
    elif counts == "inertia":
        alpha = 0.95 * lyapunov.check_gains(gains, constants=box, route="matrix").alpha_high
    else:
        goal = 0.99 * box.where["kg"] + 0.01 * goal
        alpha = 1.01 * lyapunov.check_gains(gains, constants=box, route="matrix").alpha_low
    region = lyapunov.attraction(goal, gains, alpha=alpha)

    def on_the_edge(direction):
        error = region.radius * direction / np.linalg.norm(direction)
        state = State(np.zeros(4), error, region.alpha * error, goal)  # where V is least
        return lyapunov.function(state, gains, region.alpha) / region.level

    least = min(minimize(on_the_edge, start).fun for start in rng.normal(size=(4, 4)))
    assert 1 <= least < most


def test_motions_from_the_region_stay_in_it_and_end_in_the_goal(attraction, rng):
    gains, alpha = attraction.gains, attraction.alpha
    sizes = (attraction.error, attraction.speed, attraction.w)

    def rate(t, x):
        state = State(*x.reshape(3, 4), GOAL)
        return np.concatenate(lyapunov.closed_loop_rate(state, gains, alpha))

    for kind in range(3):
        x0 = np.zeros((3, 4))
        x0[[1, 2, 0][kind]] = 0.99 * sizes[kind] * unit(rng, 1)[0]
        assert attraction.contains(*x0)
        times = np.linspace(0, 60, 61)
        run = solve_ivp(rate, (0, 60), x0.ravel(), "LSODA", times, rtol=1e-7, atol=1e-9)
        w, error, dq = run.y.reshape(3, 4, -1).transpose(0, 2, 1)
        assert attraction.contains(w, error, dq).all()
        V = lyapunov.function(State(w, error, dq, GOAL), gains, alpha)
        assert (np.diff(V) < 1e-9 * V[0]).all()
        assert np.linalg.norm(error[-1]) < 0.05 * np.linalg.norm(error, axis=-1).max()


def test_every_state_of_the_ball_is_in_the_region(attraction, rng):
    for speed, w in ((0.0, 0.0), (0.3, 0.0), (0.1, 0.2)):
        size = attraction.ball(speed=speed, w=w)
        assert 0 < size <= attraction.radius
        states = w * unit(rng, 3000), 0.9999 * size * unit(rng, 3000), speed * unit(rng, 3000)
        assert attraction.contains(*states).all()
    assert attraction.ball(speed=100.0) == 0.0
    assert attraction.ball(speed=0.3) < attraction.ball()


def test_a_state_with_a_larger_error_than_the_ball_of_the_region_is_outside(attraction):
    far = np.array([0.0, 1.01 * attraction.radius, 0.0, 0.0])
    assert not attraction.contains(np.zeros(4), far, attraction.alpha * far)


def test_over_the_joint_box_the_ball_ends_at_the_nearest_limit(attraction, tunings):
    room = np.minimum(GOAL - BACKHOE.lower, BACKHOE.upper - GOAL)[1:].min()
    assert attraction.radius == pytest.approx(room)
    everywhere = lyapunov.attraction(
        GOAL, tunings["matrix"].gains, constants=lyapunov.constants(domain="torus")
    )
    assert everywhere.radius > attraction.radius
    assert everywhere.level > attraction.level


def test_the_chosen_alpha_is_no_worse_than_others(attraction, tunings):
    gains = tunings["matrix"].gains
    certificate = lyapunov.check_gains(gains, route="matrix")
    for share in (0.2, 0.5, 0.8):
        alpha = certificate.alpha_low ** (1 - share) * certificate.alpha_high**share
        other = lyapunov.attraction(GOAL, gains, alpha=alpha)
        assert other.alpha == alpha
        assert attraction.level > 0.97 * other.level


def test_the_ball_is_as_large_as_the_largest_eigenvalues_of_v_allow(attraction):
    a, c = attraction, attraction.certificate.constants
    K = a.alpha * a.gains.kd + a.gains.kp - a.gains.ki / a.alpha
    stiff, weak = np.linalg.eigvalsh(K)[-1] + c.kg, np.linalg.eigvalsh(a.gains.ki)[-1] / a.alpha
    for speed, w in (
        (0.0, 0.0),
        (0.6 * a.speed, 0.0),
        (0.0, 0.6 * a.w),
        (0.4 * a.speed, 0.5 * a.w),
    ):
        size = np.array([w, a.ball(speed, w), speed])
        cross = a.alpha * c.lambda_max
        V = size @ [[weak, 0, 0], [0, stiff, cross], [0, cross, c.lambda_max]] @ size / 2
        assert V == pytest.approx(a.level, rel=1e-9)


def test_what_has_no_region_is_refused(tunings, rng):
    gains = tunings["matrix"].gains
    with pytest.raises(ValueError, match="goal must lie inside the joint limits"):
        lyapunov.attraction([0.0, 2.0, 0.0, 0.0], gains)
    with pytest.raises(ValueError, match=r"goal must be one angle a joint.* got shape \(2, 4\)"):
        lyapunov.attraction(np.zeros((2, 4)), gains)
    with pytest.raises(ValueError, match="got those of 5 postures"):
        lyapunov.attraction(GOAL, gains, constants=lyapunov.constants(in_box(rng, 5)))
    with pytest.raises(ValueError, match="not certified by the scalar conditions"):
        lyapunov.attraction(GOAL, gains, route="scalar")
    with pytest.raises(ValueError, match=r"speed must be one number at least 0 \[rad/s\]"):
        lyapunov.attraction(GOAL, gains).ball(speed=-1.0)


# sampling


def test_effective_inertia_is_torque_over_acceleration(rng):
    q = in_box(rng, 50)
    J = lyapunov.effective_inertia(q)
    for j in range(4):
        tau = dynamics.gravity_torque(q) + np.eye(4)[j]
        ddq = dynamics.forward_dynamics(q, np.zeros(4), tau)
        np.testing.assert_allclose(1 / ddq[:, j], J[:, j], rtol=1e-6)
    least_found = lyapunov.effective_inertia()
    assert (least_found <= lyapunov.effective_inertia(in_box(rng, 20_000)).min(axis=0)).all()


def test_sampled_radius_is_that_of_the_matrix_exponential(rng):
    kp, ki, kd = gains = Gains(*map(np.diag, PRINTINGS["eq_333"]))
    dt = 0.004
    for q in in_box(rng, 5):
        M, H = dynamics.mass_matrix(q), lyapunov.gravity_slope(q)
        A = np.zeros((12, 12))
        A[:4, 4:8] = np.eye(4)
        A[4:8, :4], A[4:8, 8:] = -np.linalg.solve(M, H), np.linalg.inv(M)
        held = expm(A * dt)[:8]
        sample = np.zeros((12, 12))
        feedback = -np.hstack([kp + dt * ki, kd, ki])
        sample[:8] = np.hstack([held[:, :8], np.zeros((8, 4))]) + held[:, 8:] @ feedback
        sample[8:, :4], sample[8:, 8:] = dt * np.eye(4), np.eye(4)
        expected = np.abs(np.linalg.eigvals(sample)).max()
        assert lyapunov.sampled_radius(gains, q, dt) == pytest.approx(expected, rel=1e-9)


def test_a_single_joint_bears_twice_its_effective_inertia_over_the_sample():
    floating, q = replace(BACKHOE, gravity=0.0), np.array([0.0, 0.2, 0.0, 0.5])
    J, weak = lyapunov.effective_inertia(q), np.full(4, 10.0)
    for j in range(4):
        for share, stable in ((0.98, True), (1.02, False)):
            kd = np.full(4, 100.0)
            kd[j] = share * 2 * J[j] / 0.001
            radius = lyapunov.sampled_radius(Gains(weak, weak / 1e4, kd), q, machine=floating)
            assert (radius < 1) == stable


def sampled_speeds(gains, goal, samples, dt=0.001):
    """Norm of the joint speeds after each sample, from a microradian beside the goal."""
    kp, ki, kd = gains
    q, dq, integral = goal - 1e-6, np.zeros(4), dynamics.gravity_torque(goal) / ki
    speeds = []
    for _ in range(samples):
        integral = integral + dt * (goal - q)
        tau = kp * (goal - q) - kd * dq + ki * integral

        def rate(t, x, tau=tau):
            ddq = dynamics.forward_dynamics(x[:4], x[4:], tau)
            return np.concatenate([x[4:], ddq])

        run = rk4(rate, np.concatenate([q, dq]), dt / 2, 2)
        q, dq = np.split(run.x[-1], 2)
        speeds.append(np.linalg.norm(dq))
    return np.array(speeds)


def test_a_sampled_motion_grows_as_the_radius_says(tunings):
    goal = np.array([0.0, 0.5, 1.0, 1.3])
    radius = lyapunov.sampled_radius(PRINTINGS["table_31"], goal)
    assert radius > 1.2
    speeds = sampled_speeds(PRINTINGS["table_31"], goal, 30)
    assert (speeds[25] / speeds[15]) ** 0.1 == pytest.approx(radius, rel=0.02)
    tuning = tunings["matrix"]
    assert lyapunov.sampled_radius(tuning.gains, goal) < 1
    speeds = sampled_speeds(tuning.gains, goal, 400)
    assert speeds[200:].max() < 0.8 * speeds[:200].max()


# tuning


@pytest.mark.parametrize("route", ROUTES)
def test_tuned_gains_are_certified_and_can_be_sampled(route, tunings):
    tuning = tunings[route]
    again = lyapunov.check_gains(tuning.gains, route=route, error=np.pi / 2, alpha=tuning.alpha)
    assert again.require().holds
    assert tuning.stable and tuning.possible > 1
    assert (tuning.gains.kd <= tuning.kd_limit).all()
    assert (tuning.gains.kd >= tuning.kd_needed).all()
    np.testing.assert_allclose(tuning.saturation_error * tuning.gains.kp, BACKHOE.torque_limit)
    np.testing.assert_allclose(tuning.saturation_speed * tuning.gains.kd, BACKHOE.torque_limit)


def test_the_needed_damping_is_needed(tunings):
    tuning = tunings["matrix"]
    short = tuning.gains._replace(kd=tuning.kd_needed / 3)
    certificate = lyapunov.check_gains(short, route="matrix", error=np.pi / 2, alpha=tuning.alpha)
    assert not certificate.holds


def test_the_matrix_conditions_allow_hundreds_of_times_the_integral_action(tunings):
    assert (tunings["matrix"].gains.ki > 50 * tunings["scalar"].gains.ki).all()


def test_for_the_same_integral_gain_each_route_needs_less_damping(box):
    needed = [lyapunov.tune(route, ki=[2e4] * 4, constants=box).kd_needed.sum() for route in ROUTES]
    assert needed[0] > 100 * needed[1] > 100 * needed[2]


def test_it_says_when_no_damping_is_both_enough_and_possible():
    tuning = lyapunov.tune("scalar", kp=[9e5] * 4, ki=[5400.0] * 4)
    assert tuning.certificate.holds
    assert not tuning.stable
    assert tuning.possible < 1
    assert "K_i must be" in tuning.table() and "UNSTABLE" in tuning.table()
    less = lyapunov.tune("scalar", kp=[9e5] * 4, ki=[0.9 * tuning.possible * 5400.0] * 4)
    assert less.possible > 1 and less.stable


def test_a_slower_controller_bears_less(tunings):
    slow = lyapunov.tune("scalar", dt=0.01)
    assert (slow.gains.ki < 0.2 * tunings["scalar"].gains.ki).all()
    np.testing.assert_allclose(slow.kd_limit, tunings["scalar"].kd_limit / 10)


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ({"route": "best"}, "route must be one of scalar, matrix, exact, got 'best'"),
        ({"kp": [1e6, 1e6, 1e6, 1e5]}, "bucket is 100000, k_g is 181068"),
        (
            {"kp": [1e6, 1e6, 1e6]},
            r"K_p must be gains, one a joint, shape \(4,\), got shape \(3,\)",
        ),
        ({"ki": [1.0, 1.0, 1.0, -1.0]}, "K_i must be positive definite"),
        ({"error": 0.0}, r"error must be one number above 0 \[rad\]"),
        ({"dt": np.nan}, r"dt must be one number above 0 \[s\]"),
        ({"margin": 1.0}, "margin must be one number above 1"),
        ({"damping": -1}, "damping must be one number above 0"),
    ],
)
def test_what_cannot_be_tuned_is_refused(arguments, complaint):
    with pytest.raises(ValueError, match=complaint):
        lyapunov.tune(**arguments)


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ({"route": "best"}, "route must be one of"),
        ({"error": -0.1}, r"error must be one number above 0 \[rad\], got -0.1"),
        ({"alpha": 0}, r"alpha must be one number above 0 \[1/s\], got 0"),
    ],
)
def test_what_cannot_be_judged_is_refused(arguments, complaint):
    with pytest.raises(ValueError, match=complaint):
        lyapunov.check_gains(PRINTINGS["eq_333"], **arguments)


def test_constants_that_are_none_are_refused():
    with pytest.raises(
        TypeError, match=r"got float: give what lyapunov\.constants\(\.\.\.\) returns"
    ):
        lyapunov.check_gains(PRINTINGS["eq_333"], constants=24068.0)
    with pytest.raises(TypeError, match="constants must be a Constants"):
        lyapunov.attraction(GOAL, PRINTINGS["eq_333"], constants=24068.0)
    with pytest.raises(TypeError, match="constants must be a Constants"):
        lyapunov.tune(constants=24068.0)


def test_postures_that_are_none_are_refused():
    with pytest.raises(ValueError, match="q must end in 4 joints"):
        lyapunov.effective_inertia(np.zeros(3))
    with pytest.raises(ValueError, match="domain must be one of box, torus"):
        lyapunov.effective_inertia(domain="world")
    with pytest.raises(ValueError, match="dt must be one number above 0"):
        lyapunov.sampled_radius(Gains(*[[1.0] * 4] * 3), np.zeros(4), dt=0.0)
    assert domain_of(np.zeros(4)).q.shape == (1, 4)
