"""What lesson 04 accepts and claims beside its references, which `oracles` proves."""

import numpy as np
import pytest

from backhoe import simulation
from backhoe.arm.pid import DigitalPID
from backhoe.lessons.skid_steer.exercises import regulator, wheel_motor
from backhoe.machine import BACKHOE
from backhoe.simulation.tracks import patch_positions
from backhoe.vehicle import motor, skid_steer
from backhoe.vehicle.skid_steer import HUSKY, replace

rng = np.random.default_rng(4)


def test_the_librarys_clamping_passes_though_it_gives_other_outputs_at_a_tight_limit():
    error = rng.normal(size=200)
    for limit, alike in ((1e3, True), (3.0, False)):
        pi = DigitalPID(2.0, 30.0, 0.0, 0.01, limits=(-limit, limit))
        theirs = np.array([pi(float(e), 0.0) for e in error])
        ours = regulator.sampled_pi(error, 0.01, 2.0, 30.0, limit)
        assert np.allclose(ours, theirs, atol=1e-9) == alike
        assert regulator.right_clamping(theirs, ours, error, 0.01, 2.0, 30.0, limit)


def test_each_demand_can_fail_alone():
    load = motor.first_order(motor.ROVER, motor.vehicle_load(HUSKY))
    late = 1 / (load.gain * 0.4), 1 / (load.gain * 0.4 * load.time_constant), 0.0
    assert [len(wheel_motor.demands(gains)) for gains in (late, (8.0, 0.0, 0.0))] == [1, 1]


def test_what_is_said_about_slip_no_icr_cancels_the_slip_of_both_axles():
    for x_icr in np.linspace(-0.25, 0.25, 11):
        slip = skid_steer.contact_velocity([1.0, -0.5 * x_icr, 0.5])[:, 1]
        assert np.ptp(slip) == pytest.approx(0.5 * (HUSKY.front + HUSKY.rear))
    assert skid_steer.contact_velocity([1.0, 0.0, 0.5])[0, 1] == pytest.approx(0.5 * HUSKY.front)


def test_two_motors_do_as_well_as_four_behind_the_printed_gear_but_not_without_it():
    saved = {}
    for gear in (1.0, 100.0):
        geared = replace(motor.WHEELCHAIR, gear=gear)
        two, four = (
            1 / motor.first_order(geared, motor.vehicle_load(HUSKY, driven)).gain
            for driven in (2, 4)
        )
        saved[gear] = 1 - four / two
    assert saved[1.0] == pytest.approx(0.42, abs=0.01)
    assert saved[100.0] < 0.001


def test_the_gear_divides_the_speed_and_spares_the_motor_its_load():
    bare, geared = (replace(motor.WHEELCHAIR, gear=gear) for gear in (1.0, 100.0))
    assert bare.no_load_speed / geared.no_load_speed == pytest.approx(100.0)
    load = motor.hanging_wheel(HUSKY)
    times = [motor.first_order(m, load).time_constant for m in (bare, geared)]
    assert 100 < times[0] / times[1] < 120


def test_tracks_push_alike_straight_on_and_against_each_other_on_the_spot():
    pairs = {}
    for name, wish in (("straight", (0.5, 0.0)), ("spot", (0.0, 0.3)), ("both", (0.5, 0.2))):
        with simulation.TrackedPlant(backend="analytic") as excavator:
            while excavator.time < 3.0:
                excavator.step(*wish)
            pairs[name] = excavator.traction
    assert pairs["straight"][0] == pytest.approx(pairs["straight"][1], rel=1e-6)
    assert pairs["spot"][0] == pytest.approx(-pairs["spot"][1], rel=0.1)
    assert abs(pairs["both"].sum()) > 0.1 * abs(pairs["both"]).max()


def test_the_balance_of_moments_predicts_how_the_excavator_turns():
    from scipy.optimize import brentq

    x, y = patch_positions(BACKHOE).T
    ground = np.array([BACKHOE.tracks.friction_longitudinal, BACKHOE.tracks.friction_lateral])

    def moment(belt):
        slip = np.array([-y + np.sign(y) * belt, x])
        F = -ground[:, None] * slip / np.hypot(*slip)
        return (x * F[1] - y * F[0]).sum()

    with simulation.TrackedPlant(backend="analytic") as excavator:
        while excavator.time < 6.0:
            excavator.step(0.0, 0.3)
        left, right = excavator.belts
        measured = (right - left) / (2 * excavator.twist[1])
    assert measured == pytest.approx(
        brentq(moment, BACKHOE.tracks.gauge / 2 + 0.01, 5.0), rel=0.005
    )
