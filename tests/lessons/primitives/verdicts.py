"""What decides each verdict on chapter 6 of Mastalli and its appendix B: properties and forms."""

from functools import cache
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize

from backhoe.arm.kinematics import inverse_kinematics
from backhoe.lessons.primitives import printed
from backhoe.machine import BACKHOE
from backhoe.mission import hauling
from backhoe.planning.dmp import DMP, demonstration
from backhoe.planning.dmp.spring import follow, step_matrix
from backhoe.simulation.soil import SANDY_LOAM
from backhoe.simulation.soil.bucket_fill import BucketFill

K, D, TAU, T = 400.0, 40.0, 1.5, 3.0


def _shown(n=1501):
    """A movement with its derivatives in closed form, from 0.3 to 1.1 at rest."""
    t = np.linspace(0, T, n)
    u, w = t / T, np.pi / T
    x = 0.3 + 0.8 * u**3 * (10 - 15 * u + 6 * u**2) + 0.2 * np.sin(w * t) ** 4
    dx = 24 / T * u**2 * (1 - u) ** 2 + 0.8 * w * np.sin(w * t) ** 3 * np.cos(w * t)
    ddx = 48 / T**2 * u * (1 - u) * (1 - 2 * u)
    ddx = ddx + 0.8 * w**2 * (3 * np.sin(w * t) ** 2 * np.cos(w * t) ** 2 - np.sin(w * t) ** 4)
    return t, x, dx, ddx, np.exp(-5.25 * t / T)


# Policies: (6.1) to (6.3)


def policy_decides_by_state_and_time(policy):
    """Other states, other times and other parameters each change the command."""
    base = np.array([policy(0.2, 0.5, 1.0), policy(0.4, 0.5, 1.0)])
    assert base[0] != base[1]
    assert policy(0.2, 0.5, 1.0) != policy(0.2, 0.7, 1.0)
    assert policy(0.2, 0.5, 1.0) != policy(0.2, 0.5, 2.0)


def policy(x, t, alpha):
    return K * (1 - x) + alpha * np.exp(-t)


def policy_without_the_state(x, t, alpha):
    return K + alpha * np.exp(-t)


def choice_pays_most_on_average(choose):
    """Ten thousand throws of the dice for each action."""
    rng = np.random.default_rng(0)
    rewards = np.array([[1.0, 1.2], [5.0, -9.0], [0.0, 2.0]])
    chances = np.array([[0.5, 0.5], [0.3, 0.7], [0.5, 0.5]])
    paid = [rng.choice(r, 10_000, p=p).mean() for r, p in zip(rewards, chances, strict=True)]
    assert choose(rewards, chances) == int(np.argmax(paid))


def best_action_on_average(rewards, chances):
    return int((np.asarray(rewards) * chances).sum(axis=1).argmax())


def clock_runs_whatever_the_arm_does(system):
    ends = []
    for x in (-1.0, 0.0, 2.0):
        found = solve_ivp(lambda t, y: system(*y), (0, T), [x, 1.0], rtol=1e-9, atol=1e-12)
        ends.append(found.y[1, -1])
    assert np.ptp(ends) < 1e-6


def transformation_and_canonical_system(x, s):
    return 3 * (1 - x) + s, -s


def clock_that_waits_for_the_arm(x, s):
    return 3 * (1 - x) + s, -s / (1 + (1 - x) ** 2)


# The primitive: (6.4) to (6.11)


def begins_gently_and_ends_at_the_goal(law):
    """SciPy integrates the law, without and with a force that fades."""
    for x0, g, push in ((0.0, 1.0, 0.0), (0.5, -0.4, 3.0)):
        assert abs(law(x0, 0.0, 1.0, x0, g, 0.0)) < 1e-12

        def rates(t, y, x0=x0, g=g, push=push):
            s = np.exp(-5.25 * t / T)
            return [y[1] / TAU, law(y[0], y[1], s, x0, g, push * s) / TAU]

        end = solve_ivp(rates, (0, 3 * T), [x0, 0.0], rtol=1e-9, atol=1e-10).y[0, -1]
        assert abs(end - g) < 1e-4


def spring_with_a_gentle_start(x, v, s, x0, g, f):
    return K * (g - x) - D * v - K * (g - x0) * s + K * f


def spring_with_the_start_doubled(x, v, s, x0, g, f):
    return K * (g - x) - D * v + K * (g - x0) * s + K * f


def _psi(s):
    centres = np.exp(-5.25 * np.linspace(0, 1, 9))
    return np.exp(-0.5 * ((s[:, None] - centres) / (0.12 * (centres + 0.05))) ** 2)


def force_is_the_phase_times_a_mean_of_the_weights(f):
    s = np.exp(-5.25 * np.linspace(0, 1, 60))
    w = np.random.default_rng(1).normal(size=9)
    assert np.allclose(f(s, np.full(9, 0.7)), 0.7 * s)
    share = f(s, w) / s
    assert w.min() - 1e-9 <= share.min() and share.max() <= w.max() + 1e-9


def mixed_force(s, w):
    return _psi(s) @ w * s / _psi(s).sum(axis=1)


def force_without_the_sum_below(s, w):
    return _psi(s) @ w * s


def neurons_sum_to_the_phase(F):
    s = np.exp(-5.25 * np.linspace(0, 1, 60))
    assert np.allclose(F(s).sum(axis=1), s)


def neurons(s):
    return _psi(s) * s[:, None] / _psi(s).sum(axis=1, keepdims=True)


def neurons_without_the_phase(s):
    return _psi(s) / _psi(s).sum(axis=1, keepdims=True)


def phase_falls_from_one_to_nought(rate):
    found = solve_ivp(
        lambda t, s: rate(s), (0, 20), [1.0], dense_output=True, rtol=1e-9, atol=1e-12
    )
    s = found.sol(np.linspace(0, 20, 100))[0]
    assert found.success and (np.diff(s) < 0).all() and 0 <= s[-1] < 1e-3


def canonical_system(s):
    return -0.5 * s


def canonical_system_with_a_plus(s):
    return 0.5 * s


def phase_settles_there(value):
    end = solve_ivp(lambda t, s: -5.25 * s, (0, 10), [1.0], rtol=1e-9, atol=1e-12).y[0, -1]
    assert abs(end - value) < 1e-6


NOUGHT = 0.0


def force_plays_the_demonstration_back(target):
    """SciPy integrates (6.4) with the target force."""
    t, x, dx, ddx, s = _shown()
    f = target(x, dx, ddx, s)
    x0, g = x[0], x[-1]

    def rates(at, y):
        now, push = np.exp(-5.25 * at / T), np.interp(at, t, f)
        return [y[1] / TAU, spring_with_a_gentle_start(*y, now, x0, g, push) / TAU]

    found = solve_ivp(rates, (0, T), [x0, 0.0], t_eval=t, rtol=1e-6, atol=1e-8, max_step=0.05)
    assert np.abs(found.y[0] - x).max() < 1e-3


def target_force(x, dx, ddx, s):
    v, dv = TAU * dx, TAU * ddx
    return (TAU * dv + D * v) / K - (x[-1] - x) + (x[-1] - x[0]) * s


def target_force_with_v_the_velocity(x, dx, ddx, s):
    return (TAU * ddx + D * dx) / K - (x[-1] - x) + (x[-1] - x[0]) * s


def error_is_least_at_numpys_least_squares(J):
    rng = np.random.default_rng(2)
    F, y = rng.normal(size=(40, 3)), rng.normal(size=40)
    best = np.linalg.lstsq(F, y, rcond=None)[0]
    for _ in range(20):
        assert J(y, F @ best) < J(y, F @ (best + 0.3 * rng.normal(size=3)))


def squared_error(target, f):
    return ((target - f) ** 2).sum()


def error_without_the_square(target, f):
    return (target - f).sum()


def phase_is_used_up_at_the_end(rate):
    """Between half and one hundredth of a per cent is left after t_e, by SciPy."""
    left = solve_ivp(lambda t, s: -rate / T * s, (0, T), [1.0], rtol=1e-9).y[0, -1]
    assert 1e-4 < left < 1e-2


RATE_TEN_TIMES_TOO_SMALL = 0.525


@cache
def _force(stiffness, damping):
    _, x, dx, ddx, s = _shown()
    return (TAU**2 * ddx + damping * TAU * dx) / stiffness - (x[-1] - x) + (x[-1] - x[0]) * s


def _played(stiffness, damping, tau, alpha, seconds):
    """Positions of (6.4) over even shares of a duration, exactly for even pieces of the pull."""
    x = _shown()[1]
    share = np.linspace(0, 1, len(x))
    s = np.exp(-alpha / tau * seconds * share)
    f = np.interp(s, np.exp(-5.25 * share)[::-1], _force(stiffness, damping)[::-1])
    pull = (x[-1] - (x[-1] - x[0]) * s + f)[:, None]
    M = step_matrix(seconds / (len(x) - 1), stiffness, damping, tau)
    return follow(pull, x[:1], np.zeros(1), M)[0][:, 0]


def half_the_duration_has_the_same_shape(form):
    tau, alpha = form(TAU, T / 2)
    off = _played(K, D, tau, alpha, T / 2) - _shown()[1]
    assert np.sqrt(np.mean(off**2)) < 1e-3


def tau_stretched(tau, seconds):
    return tau * seconds / T, 5.25 * tau / T


printed_tau_and_alpha = printed.tau_and_alpha


# Tuning: 6.7.1


def springs_have_two_equal_roots(tuning):
    for stiffness, damping in zip(tuning["stiffness"], tuning["damping"], strict=True):
        below, above = (np.roots([1, d * damping, stiffness]) for d in (1 - 1e-6, 1 + 1e-6))
        assert np.iscomplex(below).all() and np.isreal(above).all()


CRITICAL = {"stiffness": [5e3, 5e4], "damping": [2 * 5e3**0.5, 2 * 5e4**0.5]}


def spring_has_this_order(order):
    """Rank of the Hankel matrix of its answer to a push."""
    M = step_matrix(0.02, 5e4, 2 * 5e4**0.5, 6.0)[:, :2]
    x, answer = np.array([0.0, 1.0]), []
    for _ in range(12):
        x = M @ x
        answer.append(x[0])
    hankel = np.array([answer[k : k + 6] for k in range(6)])
    assert np.linalg.matrix_rank(hankel, tol=1e-6 * np.abs(hankel).max()) == order


SECOND_ORDER = 2


def step_is_stable_by_every_explicit_rule(dt):
    """Euler, semi-implicit Euler, midpoint, Runge-Kutta 4: their matrices written here."""
    A = np.array([[0, 1], [-5e4 / 36, -425 / 6]]) * dt
    one = np.eye(2)
    euler = one + A
    semi = np.array([[1, 0] + A[0, 1] * euler[1], euler[1]])
    rk2 = euler + A @ A / 2
    rk4 = rk2 + A @ A @ A / 6 + A @ A @ A @ A / 24
    for M in (euler, semi, rk2, rk4):
        assert np.abs(np.linalg.eigvals(M)).max() < 1


STABLE_BY_ALL = 0.0229


@cache
def _replays(noise):
    """RMSE of the learnt force and of the replay for both tunings, shape (2, 2, 4)."""
    t, x = demonstration("dig", 0.002)
    seen = x + noise * np.random.default_rng(0).standard_normal(x.shape)
    found = []
    for stiffness, damping in ((5e3, 125.0), (5e4, 425.0)):
        dmp = DMP(100, stiffness, damping, TAU * 4, fit="lwr").learn(seen, t)
        replay = np.sqrt(np.mean((dmp.rollout()[1] - x) ** 2, axis=0))
        found.append((dmp.forcing_error(), replay))
    return np.array(found)


def replay_is_better_by_this_factor(factor):
    """Against the true movement, in x and z, from a clean and from a noisy recording."""
    for noise in (0.0, 2e-4):
        bad, good = _replays(noise)[:, 1, [0, 2]]
        assert np.allclose(bad / good, factor, rtol=0.35)


NO_BETTER = 1.0


def forces_are_those_of_a_smooth_demonstration(pair):
    """Their errors hardly depend on K; those of noise fall as 1 / K."""
    pair = pair() if callable(pair) else pair
    bad, good = np.array(pair["badly_tuned"]), np.array(pair["well_tuned"])
    assert np.all((bad / good > 0.7) & (bad / good < 1.4))


def our_table():
    bad, good = _replays(0.0)[:, 0]
    return {"badly_tuned": bad, "well_tuned": good}


def units_are_those_of_x_y_z_and_an_angle(units):
    """f is measured as the dimension that it moves: (6.8) adds it to g - x."""
    assert list(units) == ["m", "m", "m", "rad"]


UNITS = ["m", "m", "m", "rad"]


def means_are_right_to_the_last_digit(table):
    for work in ("dig", "load"):
        assert abs(np.mean(table[work]["rmse"]) - table[work]["mean"]) < 6e-5


def _means(dig, load):
    return {
        "dig": {"rmse": [0.3498, 0.5293, 0.6294, 0.6285], "mean": dig},
        "load": {"rmse": [0.5792, 0.7628, 0.2618, 0.5630], "mean": load},
    }


MEANS, MEANS_EXCHANGED = _means(0.53425, 0.5417), _means(0.5417, 0.53425)


def quick_parts_are_lost(fit):
    """A slow and a quick wave: how much of each is learnt."""
    from backhoe.planning.dmp.kernels import Kernels
    from backhoe.planning.dmp.kernels import fit as weights_of

    u = np.linspace(0, 1, 900)
    basis = Kernels(40).basis(u)
    kept = []
    for waves in (1, 8):
        wave = (basis.s * np.sin(2 * np.pi * waves * u))[:, None]
        learnt = basis.mixed(weights_of([basis], [wave], fit, 1e-9))
        kept.append(float((learnt * wave)[200:700].sum() / (wave**2)[200:700].sum()))
    assert kept[1] < 0.75 * kept[0] and kept[0] > 0.8


LOCALLY_WEIGHTED, ALL_TOGETHER = "lwr", "ridge"


def form_makes_the_bulge_grow_with_the_goal(name):
    """Goal 1 m further out: how far beyond the goal does the dig bulge?"""
    t, x = demonstration("dig", 0.02)
    dmp = DMP(60, formulation=name).learn(x, t)
    bulges = [
        dmp.rollout(goal=dmp.goal + np.array([shift, 0, 0, 0]))[1][:, 0].max() - x[-1, 0] - shift
        for shift in (0, 1)
    ]
    assert bulges[1] > 2 * bulges[0]


ORIGINAL_FORM = "ijspeert"


def new_goal_gives_this_movement(form):
    """Roll-out to goals 1 m further and 0.3 m nearer, K = 50000."""
    t, x = demonstration("dig", 0.02)
    dmp = DMP().learn(x, t)
    for shift in (1.0, -0.3):
        goal = dmp.goal + np.array([shift, 0, 0, 0])
        found = dmp.rollout(goal=goal)[1]
        s = np.exp(-5.25 * t / t[-1])
        assert np.abs(form(x[:, 0], s, goal[0]) - found[:, 0]).max() < 0.03 * abs(shift)


def demonstration_and_a_shift_that_grows(x, s, goal):
    return x + (goal - x[-1]) * (1 - s)


def shape_is_kept(x, s, goal):
    return x[0] + (goal - x[0]) / (x[-1] - x[0]) * (x - x[0])


def arm_reaches_all(goals):
    try:
        inverse_kinematics(np.array(goals))
    except ValueError as error:
        raise AssertionError(error) from error


GOALS_BELOW_THE_GROUND = [[5.45, -0.40, -1.84, 0.0], [6.0, -0.5, -4.0, -0.3]]
PAPER_GOALS_UPRIGHT = [[1.87, 3.60, 4.44, 1.3], [2.50, 4.00, 4.44, 1.3]]


def arm_reaches_each_goal_of_the_paper(goals):
    arm_reaches_all(goals)
    assert len(goals) == 2


def searches_spill_a_loaded_bucket(spills):
    """RRT-Connect that keeps the bucket level, from the heap to the truck; lesson 11b has more."""
    start, goal = inverse_kinematics([[6.2, 0.0, 3.4, -0.6], [0.4, 5.7, 3.9, -0.5]])
    fill = BucketFill(BACKHOE.shell, SANDY_LOAM.repose)
    path = hauling.level_way(start, goal, hauling.arm_world())
    between = np.concatenate([np.linspace(a, b, 30) for a, b in pairwise(path)])
    tilt = between[:, 1:].sum(axis=1) + sum(link.angle_offset for link in BACKHOE.links)
    held = min(fill.retained(pitch) for pitch in tilt.tolist())
    assert (fill.heaped - held > 0.05 * fill.heaped) == spills


SEARCHES_SPILL = False


# Appendix B


def loss_makes_the_best_constant_a_median(J):
    y = np.array([0.0, 1.0, 2.0, 10.0, 11.0, 50.0, 60.0])
    costs = [J(lambda a, b: abs(a - b), np.full(7, c), y) for c in y]
    assert y[int(np.argmin(costs))] == np.median(y)


def sum_of_losses(L, f, y):
    return sum(map(L, f, y))


def sum_of_squared_losses(L, f, y):
    return sum(L(a, b) ** 2 for a, b in zip(f, y, strict=True))


def squares_make_the_best_constant_a_mean(J):
    y = np.random.default_rng(3).exponential(size=30)
    best = minimize(lambda c: J(np.full(30, c[0]), y), [0.5], method="Nelder-Mead").x[0]
    assert abs(best - y.mean()) < 1e-3


def sum_of_squares(f, y):
    return ((f - y) ** 2).sum()


def sum_of_amounts(f, y):
    return np.abs(f - y).sum()


def linear_model_is_fitted_as_by_numpy(J):
    rng = np.random.default_rng(4)
    X, y = rng.normal(size=(50, 3)), rng.normal(size=50)
    best = minimize(lambda w: J(X, y, w), np.zeros(3), tol=1e-12).x
    assert np.allclose(best, np.linalg.lstsq(X, y, rcond=None)[0], atol=1e-5)


def linear_squares(X, y, w):
    return ((X @ w - y) ** 2).sum()


def linear_squares_of_the_sum(X, y, w):
    return (X @ w - y).sum() ** 2 + 1e-3 * w @ w


def letter_is_that_of_the_criterion(letter):
    assert letter == "omega"  # of (B.1) to (B.3), and of the estimate below (B.4)


OMEGA = "omega"


def near_samples_decide(J):
    """The best constant at q is the mean of what lies near q."""
    x = np.r_[np.zeros(20), np.full(20, 5.0)]
    y = np.r_[np.full(20, 1.0), np.full(20, 3.0)]
    for q, near in ((0.0, 1.0), (5.0, 3.0)):
        best = minimize(lambda c, q=q: J(x, y, c[0], q), [2.0], method="Nelder-Mead").x[0]
        assert abs(best - near) < 1e-3


def weighted_squares(x, y, c, q):
    return ((c - y) ** 2 * np.exp(-((x - q) ** 2))).sum()


def weighted_by_the_distance(x, y, c, q):
    return ((c - y) ** 2 * np.abs(x - q)).sum()


def its_square_is_the_kernel(psi):
    for h, d in ((0.5, 0.3), (4.0, 1.2), (9.0, 0.1)):
        assert abs(psi(h, d) ** 2 - np.exp(-h * d**2)) < 1e-12


def root(h, d):
    return np.exp(-h * d**2 / 2)


printed_root = printed.root_of_the_kernel


def _local(seed):
    rng = np.random.default_rng(seed)
    X, y = rng.normal(size=(40, 3)), rng.normal(size=40)
    return X, y, np.exp(-((X - rng.normal(size=3)) ** 2).sum(axis=1))


def least_where_the_weighted_criterion_is(J):
    """The same parameters as (B.5), found by SciPy."""
    X, y, kernel = _local(5)
    best = minimize(lambda w: (kernel * (X @ w - y) ** 2).sum(), np.zeros(3), tol=1e-12).x
    found = minimize(lambda w: J(X, y, w, np.sqrt(kernel)), np.zeros(3), tol=1e-12).x
    assert np.allclose(found, best, atol=1e-4)


def weighted_rows(X, y, w, psi):
    return (((psi[:, None] * X) @ w - psi * y) ** 2).sum()


def weighted_rows_without_the_values(X, y, w, psi):
    return (((psi[:, None] * X) @ w - y) ** 2).sum()


def solves_the_weighted_squares(solve):
    for seed in range(5):
        X, y, kernel = _local(seed)
        best = minimize(
            lambda w, c=(X, y, kernel): (c[2] * (c[0] @ w - c[1]) ** 2).sum(),
            np.zeros(3),
            tol=1e-12,
        ).x
        assert np.allclose(solve(X, y, np.sqrt(kernel)), best, atol=1e-4)


def normal_equations(X, y, psi):
    Z, v = psi[:, None] * X, psi * y
    return np.linalg.inv(Z.T @ Z) @ Z.T @ v


def normal_equations_with_the_kernel_squared(X, y, psi):
    return normal_equations(X, y, psi**2)
