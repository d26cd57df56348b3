"""PyBullet's bare arm against our model: what it integrates, and what its defaults do to a fall."""

import numpy as np
import pytest

from backhoe.arm import dynamics, integrate, kinematics
from backhoe.lessons import published
from backhoe.lessons.dynamics import bench
from backhoe.machine import BACKHOE
from backhoe.simulation import bullet

CASE = published.load("mastalli_2013_free_fall")
START, TORQUE = np.radians(CASE["start_deg"]), np.array(CASE["case_1"]["torque"])


def acceleration(t, q, dq):
    return dynamics.forward_dynamics(q, dq, TORQUE)


def own_fall(steps):
    state = np.concatenate([START, np.zeros(4)])
    return integrate.semi_implicit_euler(acceleration, state, 1.0 / steps, steps)


def test_pybullet_is_semi_implicit_euler_on_our_equations():
    pytest.importorskip("pybullet")
    np.testing.assert_allclose(
        bench.let_go(START, TORQUE, 1.0, dt=0.004).x, own_fall(250).x, atol=1e-9
    )


def test_pybullet_converges_to_the_exact_fall_at_first_order():
    pytest.importorskip("pybullet")
    exact = integrate.rk4(
        integrate.motion(acceleration), np.concatenate([START, np.zeros(4)]), 0.001, 1000
    ).x[-1]
    coarse, fine = (
        np.abs(bench.let_go(START, TORQUE, 1.0, dt=dt).x[-1] - exact).max() for dt in (0.004, 0.002)
    )
    assert coarse / fine == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize(("default", "degrees"), [("damping", 0.5), ("motors", 16.0)])
def test_pybullets_defaults_bend_the_fall(default, degrees):
    pytest.importorskip("pybullet")
    free = bench.let_go(START, TORQUE, 1.0)
    bent = bench.let_go(START, TORQUE, 1.0, **{default: True})
    off = np.degrees(np.abs(bent.x[-1] - free.x[-1])[:4]).max()
    assert off == pytest.approx(degrees, abs=0.5)


def test_without_pybullet_the_fall_is_the_same_and_nothing_is_printed(monkeypatch, capsys):
    def missing():
        raise ImportError("not here")

    monkeypatch.setattr(bullet, "pybullet", missing)
    fall = bench.let_go(START, TORQUE, 0.1, dt=0.01)
    assert not capsys.readouterr().out
    np.testing.assert_allclose(fall.x, own_fall(100).x[:11], atol=1e-12)


def test_the_replay_of_a_fall_stands_on_the_stand_with_the_way_of_the_other_one():
    q = own_fall(20).x[:, :4]
    shown = bench.watch(np.arange(21.0), q, q[:5], "a fall", "The arm falls.").recording
    way, *legs = (np.asarray(line.points) for line in shown.lines)
    lift = np.array([0.0, 0.0, bench.STAND])
    np.testing.assert_allclose(way, kinematics.forward_kinematics(q[:5])[:, :3, 3] + lift)
    top = BACKHOE.base.height + bench.STAND
    assert len(legs) == 4
    assert all(leg[:, 2].tolist() == [top - bench.STAND, top] for leg in legs)


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match=r"q must be joints .* got shape \(2,\)"):
        bench.let_go([0.0, 0.0], TORQUE, 1.0)
    with pytest.raises(ValueError, match=r"q must be joints .* got shape \(2, 4\)"):
        bench.let_go([START, START], TORQUE, 1.0)
    with pytest.raises(ValueError, match="dt must be one number above 0"):
        bench.let_go(START, TORQUE, 1.0, dt=0.0)
