"""What a primitive must do: give back what it was shown, and go to other goals as (6.4) says."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from backhoe.planning.dmp import DMP, FORMULATIONS, REMEDIES, minimum_jerk, phase

T = 4.0
t = np.linspace(0, T, 401)


def shown(t=t, T=T):
    """A reach with a detour, (m, 2), at rest at both ends; its acceleration is continuous."""
    m = minimum_jerk(t / T)[0]
    detour = (t / T) ** 3 * (1 - t / T) ** 3
    return np.column_stack([1 + 2 * m + 20 * detour, 3 - 0.5 * m - 9 * detour])


def learnt(**options):
    return DMP(kernels=50, **options).learn(shown(), t)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("spacing", ["exponential", "time"])
def test_gives_back_what_was_shown(formulation, spacing):
    times, x, v = learnt(formulation=formulation, spacing=spacing).rollout()
    assert np.abs(times - t).max() < 1e-12
    assert np.abs(x - shown()).max() < 1e-3
    assert np.abs(v - np.gradient(shown(), t, axis=0)).max() < 0.02


def test_solves_the_printed_equations():
    """(6.4) and (6.7) with v = tau dx/dt, by SciPy's integrator, for a new start, goal and time."""
    dmp, start, goal, whole = learnt(stiffness=300.0, tau=2.5), [0.8, 3.3], [2.0, 4.0], 6.0
    K, D, tau = 300.0, 2 * 300.0**0.5, 2.5 * whole / T
    centres, h = dmp.kernels.centres, dmp.kernels.sharpness

    def slope(_, y):
        x, v, s = y[:2], y[2:4], y[4]
        psi = np.exp(-h * (s - centres) ** 2)
        f = psi @ dmp.weights * s / psi.sum()
        pull = K * (goal - x) - D * v - K * np.subtract(goal, start) * s + K * f
        return [*v / tau, *pull / tau, -5.25 / whole * s]

    velocity = np.array([0.1, -0.2])
    y0 = [*start, *(tau * velocity), 1.0]
    found = solve_ivp(slope, (0, whole), y0, rtol=1e-9, atol=1e-9, t_eval=np.linspace(0, whole, 7))
    times, x, v = dmp.rollout(start, goal, whole, dt=1e-3, velocity=velocity)
    assert np.abs(x[::1000] - found.y[:2].T).max() < 1e-6
    assert np.abs(v[::1000] - found.y[2:4].T / tau).max() < 1e-5
    assert times[-1] == pytest.approx(whole)


def test_a_stiff_primitive_is_the_demonstration_and_the_shift_times_one_less_the_phase():
    """(6.4) with a new start and goal: it lags behind that by D tau / K, less the stiffer it is."""
    s, missed = phase(t, T)[:, None], []
    away, further = np.array([0.1, -0.1]), [1.4, 4.0] - shown()[-1]
    for stiffness in (1e5, 1e7):
        _, x, _ = learnt(stiffness=stiffness).rollout([1.1, 2.9], [1.4, 4.0])
        missed.append(np.abs(x - (shown() + away * s + further * (1 - s))).max())
    lag = 2 / 1e5**0.5 * 6.0
    assert missed[0] < 1.1 * lag * np.abs(further - away).max() * 5.25 / T
    assert missed[1] < missed[0] / 8


@pytest.mark.parametrize("remedy", REMEDIES)
def test_time_stretches_and_the_shape_stays(remedy):
    """tau is stretched with the duration: the same places at the same shares of it."""
    dmp = learnt(stiffness=200.0)
    slow = dmp.rollout(goal=[2.0, 2.0], duration=3 * T, remedy=remedy)
    once = dmp.rollout(goal=[2.0, 2.0], remedy=remedy)
    assert np.abs(slow[1] - once[1]).max() < 1e-9
    assert np.abs(3 * slow[2] - once[2]).max() < 1e-9
    assert slow[0][-1] == pytest.approx(3 * T)


@pytest.mark.parametrize("remedy", REMEDIES)
def test_an_exact_end_is_exact_and_keeps_the_start(remedy):
    goal = np.array([2.0, 4.0])
    plain = learnt(stiffness=300.0).rollout(goal=goal, remedy=remedy)
    times, x, v = learnt(stiffness=300.0).rollout(goal=goal, remedy=remedy, exact_end=True)
    assert np.abs(x[-1] - goal).max() < 1e-12
    again = learnt(stiffness=300.0).rollout(
        goal=goal, remedy=remedy, exact_end=True, velocity=[1, 1]
    )
    assert np.abs(again[2][-1] - v[-1]).max() < 1e-12
    assert np.abs(v[-1]).max() < 1e-3
    assert np.abs(x[:3] - plain[1][:3]).max() < 1e-4
    assert np.abs(np.gradient(x, times, axis=0)[2:-2] - v[2:-2]).max() < 0.02


def test_remedies_move_the_path_as_they_say():
    dmp, goal = learnt(stiffness=1e7), np.array([2.0, 4.0])
    way, new = shown()[-1] - shown()[0], goal - shown()[0]
    base = dmp.rollout()[1]
    scaled = dmp.rollout(goal=goal, remedy="scaled")[1]
    assert np.abs(scaled - (base[0] + (base - base[0]) * new / way)).max() < 1e-9
    timed = dmp.rollout(goal=goal, remedy="minimum_jerk")[1]
    m = minimum_jerk(t / T)[0][:, None]
    assert np.abs(timed - (base + (goal - shown()[-1]) * m)).max() < 1e-5
    turned = dmp.rollout(goal=goal, remedy="affine")[1] - base
    # the shift is along the goal's own, and follows one linear measure of the way made
    assert (
        np.abs(np.outer(turned[:, 0], goal - shown()[-1]) - turned * (goal - shown()[-1])[0]).max()
        < 1e-9
    )
    assert (
        np.abs(turned[0]).max() < 1e-12 and np.abs(turned[-1] - (goal - shown()[-1])).max() < 1e-3
    )


def test_a_remedy_asked_for_the_old_goal_changes_nothing():
    dmp = learnt()
    for remedy in REMEDIES:
        assert np.abs(dmp.rollout(remedy=remedy)[1] - dmp.rollout()[1]).max() < 1e-12


def test_the_progress_has_no_unit():
    """The second dimension in millimetres: the affine way is the same way."""
    goal, unit = np.array([2.0, 4.0]), np.array([1.0, 1000.0])
    metres = learnt().rollout(goal=goal, remedy="affine")[1]
    other = DMP(kernels=50).learn(shown() * unit, t)
    assert np.abs(other.rollout(goal=goal * unit, remedy="affine")[1] / unit - metres).max() < 1e-9
