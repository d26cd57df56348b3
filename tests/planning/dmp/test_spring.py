"""The spring's steps against closed forms, its limits against runs that settle or do not."""

from __future__ import annotations

import numpy as np
import pytest

from backhoe.planning.dmp import INTEGRATORS, phase, phase_rate, step_limit, step_matrix
from backhoe.planning.dmp.spring import follow

LIMITS = {"euler": 0.0510, "semi-implicit": 0.0230, "rk2": 0.0559, "rk4": 0.0763}


def test_exact_steps_are_the_closed_form_of_a_critically_damped_spring():
    """x = u + (a + b t) exp(-w t) with a = x0 - u, b = v0 + w a."""
    K, tau, dt, x0, v0, u = 900.0, 2.0, 0.3, 1.0, -2.0, 0.4
    w = K**0.5 / tau
    t = dt * np.arange(9)
    far_end = np.full((9, 1), u)
    x, v = follow(far_end, [x0], [v0], step_matrix(dt, K, 2 * K**0.5, tau))
    a, b = x0 - u, v0 + w * (x0 - u)
    assert x[:, 0] == pytest.approx(u + (a + b * t) * np.exp(-w * t), abs=1e-12)
    assert v[:, 0] == pytest.approx((b - w * (a + b * t)) * np.exp(-w * t), abs=1e-12)


def test_exact_steps_follow_an_even_movement_with_its_lag():
    K, D, tau, speed = 400.0, 30.0, 1.5, 0.7
    u = speed * 0.4 * np.arange(60)[:, None]
    x, v = follow(u, [0.0], [0.0], step_matrix(0.4, K, D, tau))
    assert u[-1, 0] - x[-1, 0] == pytest.approx(speed * D * tau / K, rel=1e-9)
    assert v[-1, 0] == pytest.approx(speed, rel=1e-9)


@pytest.mark.parametrize("integrator", INTEGRATORS[1:])
def test_steps_within_the_limit_settle_and_beyond_it_grow(integrator):
    """The source's spring, K = 50000, D = 425, tau = 6 s; 35 ms is too much for one"""
    limit = step_limit(50_000, 425, 6, integrator)
    assert limit == pytest.approx(LIMITS[integrator], rel=3e-3)
    for share, settles in ((0.98, True), (1.02, False)):
        M = step_matrix(share * limit, 50_000, 425, 6, integrator)
        x, _ = follow(np.zeros((3000, 1)), [1.0], [0.0], M)
        assert (np.abs(x[-5:]).max() < 1e-2) == settles


@pytest.mark.parametrize(("integrator", "order"), [("euler", 1), ("semi-implicit", 1), ("rk2", 2)])
def test_integrators_converge_with_their_order(integrator, order):
    def missed(steps):
        far_end = np.ones((steps + 1, 1))
        ends = [
            follow(far_end, [0.0], [0.0], step_matrix(1 / steps, 30, 8, 1, one))[0][-1, 0]
            for one in (integrator, "exact")
        ]
        return abs(ends[0] - ends[1])

    assert missed(200) / missed(400) == pytest.approx(2**order, rel=0.1)


def test_the_phase_solves_its_equation_and_ends_where_it_should():
    t = np.linspace(0, 13.68, 2001)
    s, alpha = phase(t, 13.68), phase_rate(13.68, tau=6.0)
    assert alpha / 6.0 == pytest.approx(5.25 / 13.68)
    assert (s[0], s[-1]) == (1.0, pytest.approx(np.exp(-5.25)))
    slope = np.gradient(s, t, edge_order=2)
    assert np.abs(6.0 * slope + alpha * s)[1:-1].max() < 1e-4


def test_wrong_springs_are_refused():
    with pytest.raises(ValueError, match="one of exact, euler"):
        step_matrix(0.1, 1, 1, 1, "heun")
    with pytest.raises(ValueError, match="stiffness must be one number at least 1e-06"):
        step_matrix(0.1, -1, 1, 1)
    with pytest.raises(ValueError, match="end_phase must be one number above 0 and below 1"):
        phase(0.0, 1.0, 1.0)
