"""The solutions that lesson 04 shows are the library's own functions in other words; its claims."""

import numpy as np
import pytest

from backhoe import simulation
from backhoe.arm.pid import DigitalPID
from backhoe.lessons.skid_steer.exercises import model, regulator, tracks, wheel_motor, wheels
from backhoe.machine import BACKHOE
from backhoe.simulation.tracks import patch_positions
from backhoe.vehicle import motor, skid_steer
from backhoe.vehicle.skid_steer import HUSKY, replace
from backhoe.view import shapes

rng = np.random.default_rng(4)
STEP = np.ones(625)


def test_wheel_speeds_are_the_librarys():
    for v, omega in rng.uniform(-1, 1, (20, 2)):
        right = skid_steer.wheel_speeds([v, omega])
        np.testing.assert_allclose(wheels.wheel_speeds(v, omega), right, rtol=1e-12)


def test_side_slip_is_the_librarys_contact_velocity():
    for omega, x_icr in rng.uniform((-1, -0.2), (1, 0.2), (20, 2)):
        slip = skid_steer.contact_velocity([0.7, -x_icr * omega, omega])[:, 1]
        np.testing.assert_allclose(wheels.side_slip(omega, x_icr), slip[[0, 2]], atol=1e-12)


def test_half_track_is_the_librarys():
    t = np.linspace(0, 5, 101)
    left, right = -(np.sin(t) ** 2), 1.1 * np.sin(t) ** 2
    theirs = skid_steer.effective_half_track(t, left, right, 0.8)
    assert wheels.half_track(t, left, right, 0.8) == pytest.approx(theirs, rel=1e-12)


def test_rates_are_the_librarys():
    vehicle = replace(HUSKY, mass=70.0, front=0.3, rear=0.3)
    np.testing.assert_allclose(model.rates(vehicle), skid_steer.rates(vehicle), rtol=1e-12)


def test_geared_step_is_the_librarys_motor():
    for speed, V, T, load, h in rng.uniform(
        (-5, -24, -20, 0.02, 0.001), (5, 24, 20, 1, 0.05), (20, 5)
    ):
        step = motor.discretise(motor.ROVER, motor.Load(load), h)
        right = step.decay * speed + step.gain * V - step.torque_gain * T
        mine = wheel_motor.geared_step(speed, V, T, load, h)
        assert mine == pytest.approx(right, rel=1e-9, abs=1e-9)


def test_sampled_pi_is_the_librarys_where_no_limit_is_near_and_a_step_apart_else():
    error = rng.normal(size=200)
    free, tight = (DigitalPID(2.0, 30.0, 0.0, 0.01, limits=(-m, m)) for m in (1e3, 3.0))
    mine = regulator.sampled_pi(error, 0.01, 2.0, 30.0, 1e3)
    np.testing.assert_allclose(mine, [free(float(e), 0.0) for e in error], atol=1e-9)
    mine = regulator.sampled_pi(error, 0.01, 2.0, 30.0, 3.0)
    theirs = np.array([tight(float(e), 0.0) for e in error])
    assert not np.allclose(mine, theirs)
    assert regulator.right_clamping(theirs, mine, error, 0.01, 2.0, 30.0, 3.0)


def test_the_librarys_own_gains_meet_the_three_demands_too():
    gains = motor.tune_wheel(motor.ROVER, motor.vehicle_load(HUSKY))
    assert wheel_motor.demands(gains) == []


def test_each_demand_can_fail_alone():
    load = motor.first_order(motor.ROVER, motor.vehicle_load(HUSKY))
    late = 1 / (load.gain * 0.4), 1 / (load.gain * 0.4 * load.time_constant), 0.0
    assert [len(wheel_motor.demands(gains)) for gains in (late, (8.0, 0.0, 0.0))] == [1, 1]


def test_tractions_give_back_force_and_moment():
    for force, moment, gauge in rng.uniform((-1, -1, 1), (1, 1, 3), (20, 3)):
        left, right = tracks.tractions(force, moment, gauge)
        assert left + right == pytest.approx(force)
        assert (right - left) * gauge / 2 == pytest.approx(moment)


def test_what_is_said_about_slip_no_icr_cancels_the_slip_of_both_axles():
    for x_icr in np.linspace(-0.25, 0.25, 11):
        slip = skid_steer.contact_velocity([1.0, -0.5 * x_icr, 0.5])[:, 1]
        assert np.ptp(slip) == pytest.approx(0.5 * (HUSKY.front + HUSKY.rear))
    assert skid_steer.contact_velocity([1.0, 0.0, 0.5])[0, 1] == pytest.approx(0.5 * HUSKY.front)


def test_the_robot_with_loose_wheels_turns_on_a_slippery_floor_and_not_on_a_rough_one():
    turned = {}
    for mu in (0.2, 1.0):
        floor = replace(HUSKY, friction_longitudinal=mu, friction_lateral=mu)
        turned[mu] = skid_steer.simulate(STEP, 0.5 * STEP, 0.02, floor).velocity[-1, 2]
    assert turned[0.2] > 5 * turned[1.0]
    assert turned[1.0] < 0.05 * 0.5


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
    assert measured == pytest.approx(brentq(moment, 1.001, 5.0), rel=0.005)


def test_the_printed_cubes_have_the_printed_inertias():
    box = shapes.box(np.full(3, -0.05), np.full(3, 0.05))
    vertices, faces = box
    corners = vertices[faces]
    a, b, c = (corners[:, i] for i in range(3))
    sixth = np.einsum("ni,ni->n", a, np.cross(b, c)) / 6
    second = (a**2 + b**2 + c**2 + a * b + b * c + c * a) / 10
    per_density = (sixth[:, None] * second).sum(axis=0)
    per_mass = (per_density[0] + per_density[1]) / shapes.volume(box)
    assert 0.6 * per_mass == pytest.approx(0.001)
    assert 600 * per_mass == pytest.approx(1.0)
