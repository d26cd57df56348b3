"""What lesson 10a says in strong words."""

from itertools import pairwise

import numpy as np
import pytest

from backhoe.arm.kinematics import forward_kinematics, inverse_kinematics, jacobian
from backhoe.planning.dmp import DMP, Kernels, demonstration, recorded, repetitions
from backhoe.planning.dmp.motion import motion
from backhoe.planning.dmp.spring import follow, step_limit, step_matrix
from backhoe.simulation import soil

TIMES, SHOWN = demonstration("dig", dt=0.02)


def test_a_primitive_ends_at_its_goal_whatever_the_force():
    primitive = DMP(40, end_phase=1e-6).learn(SHOWN, TIMES)
    for seed in range(5):
        weights = 5 * np.random.default_rng(seed).normal(size=primitive.weights.shape)
        goal = np.random.default_rng(seed).normal(size=4)
        _, x, _ = primitive.with_weights(weights).rollout(goal=goal, duration=20.0)
        assert np.abs(x[len(x) // 4] - goal).max() > 0.03
        assert np.abs(x[-1] - goal).max() < 1e-3


def test_the_two_pairs_of_the_thesis_overshoot_by_2_6_and_0_07_mm_and_critical_ones_do_not():
    far = np.r_[0.0, np.ones(4000)][:, None]
    for K, D, over in ((5e3, 125, 2.64e-3), (5e4, 425, 6.8e-5), (5e3, 2 * 5e3**0.5, 0.0)):
        M = step_matrix(2e-4, K, D, 6.0)
        x, _ = follow(far, np.zeros(1), np.zeros(1), M)
        assert max(x.max() - 1, 0) == pytest.approx(over, rel=0.01, abs=1e-9)


def test_kernels_even_in_the_phase_leave_the_second_half_to_few_and_replay_it_worse():
    late = {}
    for spacing in ("uniform", "exponential"):
        centres = -np.log(Kernels(30, spacing=spacing).centres) / 5.25  # when, as a share
        late[spacing] = int((centres > 0.5).sum())
        for fit in ("lwr", "ridge"):
            _, x, _ = DMP(30, spacing=spacing, fit=fit).learn(SHOWN, TIMES).rollout()
            first, second = np.array_split(np.linalg.norm((x - SHOWN)[:, :3], axis=1), 2)
            if spacing == "uniform":
                assert (second**2).mean() > 4 * (first**2).mean()
    assert late == {"uniform": 2, "exponential": 15}


def test_locally_weighted_regression_smooths_and_ridge_regression_does_not():
    u = np.linspace(0, 1, 800)
    s = np.exp(-5.25 * u)
    basis = Kernels(30).basis(u)
    from backhoe.planning.dmp.kernels import fit

    f = (s * np.sin(2 * np.pi * 5 * u))[:, None]
    learnt = {m: basis.mixed(fit([basis], [f], m, 1e-9)) for m in ("lwr", "ridge")}
    kept = {m: (y[300:500] / f[300:500]) for m, y in learnt.items()}
    assert np.median(kept["lwr"]) < 0.8
    assert np.median(kept["ridge"]) == pytest.approx(1.0, abs=0.02)


def test_35_ms_are_stable_for_euler_and_not_for_the_semi_implicit_rule():
    """Eigenvalues of both rules, written here."""
    K, D, tau, dt = 5e4, 425.0, 6.0, 0.035
    v_row = np.array([-dt * K / tau**2, 1 - dt * D / tau])
    euler = np.array([[1, dt], v_row])
    semi = np.array([[1, 0] + dt * v_row, v_row])
    largest = [np.abs(np.linalg.eigvals(M)).max() for M in (euler, semi)]
    assert largest[0] < 1 < largest[1]
    assert step_limit(K, D, tau, "euler") == pytest.approx(D * tau / K, rel=1e-9)
    assert step_limit(K, D, tau, "semi-implicit") < dt


def test_differences_of_a_recording_are_noise_and_parabolas_are_not():
    clean = motion(*demonstration("dig", 0.005)[::-1])
    for seed in range(3):
        log = recorded(demonstration("dig", 0.005), seed)
        truth = np.interp(log.times, clean.t, clean.a[:, 0])
        rough = motion(log.positions, log.times).a[:, 0]
        smooth = motion(log.positions, log.times, smoothing=0.5).a[:, 0]
        assert np.abs(rough).max() > 50 * np.abs(truth).max()
        assert np.sqrt(np.mean((smooth - truth) ** 2)) < 0.2


def test_five_digs_make_one_primitive_that_runs_within_their_band():
    logs = repetitions("dig", 5, seed=1)
    five = DMP(smoothing=0.5).learn([one.positions for one in logs], [one.times for one in logs])
    _, mean, spread = five.spread()
    x = five.rollout(dt=five.duration / 100)[1]
    assert (np.abs(x - mean)[:, 2] < 2 * spread[:, 2] + 0.01).all()


def test_hoffmanns_fields_sum_to_pastors_form_and_ijspeerts_scales_with_the_displacement():
    ways = {}
    for form in ("pastor", "hoffmann", "ijspeert"):
        primitive = DMP(60, formulation=form).learn(SHOWN, TIMES)
        goals = [primitive.goal + np.array([shift, 0, 0, 0]) for shift in (-1, 0, 1)]
        ways[form] = [primitive.rollout(goal=goal)[1][:, 0] for goal in goals]
    np.testing.assert_allclose(ways["pastor"], ways["hoffmann"], atol=1e-9)
    x0, g = SHOWN[[0, -1], 0]
    for way, factor in zip(ways["ijspeert"], ((g - 1 - x0), (g - x0), (g + 1 - x0)), strict=True):
        grown = x0 + factor / (g - x0) * (ways["ijspeert"][1] - x0)
        np.testing.assert_allclose(way, grown, atol=5e-3)
    there_and_back = TIMES * (TIMES[-1] - TIMES)
    with pytest.raises(ValueError, match="ijspeert"):
        DMP(formulation="ijspeert").learn(there_and_back, TIMES)


def left_after(angles, kind, dt=0.01):
    """Share of a full bucket that is left, its joint at these angles over the truck."""
    ground = soil.Ground(soil.Terrain.flat((-6, 6), (0, 9), 0.2), None, soil.SOILS[kind])
    ground.bucket_volume = full = ground.fill.heaped
    q = np.tile(inverse_kinematics([1.2, 5.7, 3.8, 1.7]), (len(angles), 1))
    q[:, 3] = angles
    velocity = (jacobian(q) @ np.gradient(q, dt, axis=0)[..., None])[:, :3, 0]
    for T_tip, v in zip(forward_kinematics(q), velocity, strict=True):
        ground.advance(T_tip, v, dt)
    return ground.bucket_volume / full


def test_at_one_top_speed_small_and_quick_swings_leave_less_clay():
    t = np.arange(0, 2.5, 0.01)
    left = [left_after(np.full(len(t), 1.7), "stiff clay")]
    for period in (2.0, 1.0, 0.5, 0.25):
        w = 2 * np.pi / period
        left.append(left_after(1.7 + 1.4 / w * np.sin(w * t), "stiff clay"))
    assert all(before > 1.3 * after for before, after in pairwise(left))
    assert left_after(np.full(len(t), 1.7), "sandy loam") == 0.0
