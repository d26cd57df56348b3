"""Strong sentences of lesson 04 that no other test proves."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from backhoe import mission
from backhoe.arm.pid import DigitalPID
from backhoe.vehicle import motor, skid_steer
from backhoe.vehicle.skid_steer import HUSKY, replace


def kept(form, T_s, K_d=0.3, N=8):
    """What of a derivative is left a sample after its input has come to rest."""
    part = DigitalPID.from_factored(1.0, 0.0, K_d, T_s, derivative_filter=N, form=form)
    part(0.0, 0.0), part(0.0, -1.0)
    before = part.derivative
    part(0.0, -1.0)
    return part.derivative / before


def test_46_neither_rings_nor_grows_at_any_sample_time_and_tustins_rule_rings_at_long_ones():
    for T_s in np.geomspace(1e-6, 1e4, 41):
        assert 0 < kept("backward", T_s) < 1
    assert kept("tustin", 0.01) > 0 > kept("tustin", 0.1)


def test_a_free_mass_under_a_pi_overshoots_whatever_its_gains_and_under_a_p_it_does_not():
    rng = np.random.default_rng(4)
    for mass, kp, ki in np.exp(rng.uniform(-4, 4, (40, 3))):
        slow = 50 * max(mass / kp, kp / ki, (mass / ki) ** 0.5)
        peaks = {}
        for name, integral in (("PI", ki), ("P", 0.0)):
            run = solve_ivp(
                lambda t, s, m=mass, k=kp, i=integral: [(k * (1 - s[0]) + i * s[1]) / m, 1 - s[0]],
                (0, slow),
                [0.0, 0.0],
                method="LSODA",
                rtol=1e-10,
                atol=1e-12,
            )
            peaks[name] = run.y[0].max()
        assert peaks["PI"] > 1 + 1e-7
        assert peaks["P"] < 1 + 1e-8


def test_without_friction_a_p_does_best_and_with_rolling_resistance_a_pi():
    """By the time-weighted error of a step of 0.6 m/s with K_p of Table 3.2; K_d adds mass."""
    for held, best in ((0.0, "P"), (12e3, "PI")):
        costs = {}
        for name, ki, kd in (("P", 0.0, 0.0), ("PI", 180e3, 0.0), ("PID", 180e3, 12e3)):
            run = solve_ivp(
                lambda t, s, i=ki, d=kd, h=held: [
                    (240e3 * (0.6 - s[0]) + i * s[1] - h * np.tanh(1e3 * s[0])) / (24.1e3 + d),
                    0.6 - s[0],
                ],
                (0, 10),
                [0.0, 0.0],
                "LSODA",
                np.linspace(0, 10, 1001),
                rtol=1e-7,
            )
            costs[name] = np.trapezoid(run.t * np.abs(0.6 - run.y[0]), run.t)
        assert min(costs, key=costs.get) == best


def test_an_integral_in_the_wheels_changes_the_circle_of_stiff_ones_by_less_than_a_hundredth():
    held = np.ones(625)
    stiff = skid_steer.simulate(held, held / 2, 0.02, replace(HUSKY, speed_gain=800.0))
    pid = skid_steer.simulate(held, held / 2, 0.02, HUSKY, motor=motor.ROVER)
    (v, _, omega), (w, _, turn) = stiff.velocity[-1], pid.velocity[-1]
    assert w / turn == pytest.approx(v / omega, rel=0.01)


def test_a_proportional_loop_stays_short_of_its_command():
    speeds = skid_steer.step_response(np.linspace(0, 125, 2001), 1.0, 0.5)
    assert speeds[:, 1].max() < 0.9931
    assert speeds[:, 3].max() < 0.4871


def test_on_its_route_no_track_needs_six_tenths_of_its_drive_and_at_the_end_it_brakes_at_once():
    drive = mission.drive(backend="analytic")
    force = np.abs(drive.traction) / 1e3
    assert force.max() < 60
    assert force[-1] == pytest.approx([44, 41], abs=2)
    assert drive.traction[-1].max() < 0 < drive.traction[-2].max()
    assert drive.margin[:-1].min() == pytest.approx(1.14, abs=0.02)
    assert drive.margin[-1] == pytest.approx(0.58, abs=0.02)
