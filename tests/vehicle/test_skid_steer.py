"""Kinematics, friction and the linear model of the skid-steer vehicle."""

import subprocess
import sys
from dataclasses import fields

import control
import numpy as np
import pytest
import sympy as sp

from backhoe.lessons import published
from backhoe.machine import BACKHOE
from backhoe.vehicle import skid_steer, travel
from backhoe.vehicle.skid_steer import HUSKY, PROVENANCE, Vehicle, replace
from units import UNITS, in_units

STEP = published.load("dangelo_2022_vehicle")["step"]
PUBLIC = published.load("husky_description")


@pytest.fixture
def rng():
    return np.random.default_rng(4)


def test_importing_vehicles_and_motors_loads_nothing_heavy():
    code = "import sys, backhoe.vehicle.skid_steer, backhoe.vehicle.motor; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert {"numba", "scipy", "control", "matplotlib", "pybullet"}.isdisjoint(loaded.stdout.split())


# The vehicle


def test_husky_has_the_public_figures():
    p = PUBLIC
    used = [HUSKY.wheel_radius, HUSKY.wheel_mass, HUSKY.wheel_width, HUSKY.wheel_inertia]
    length, _, height = p["base_size"]
    assert used == [p["wheel_radius"], p["wheel_mass"], p["wheel_length"], max(p["wheel_inertia"])]
    assert 2 * HUSKY.half_track == pytest.approx(p["track"])
    assert HUSKY.front + HUSKY.rear == pytest.approx(p["wheelbase"])
    assert (HUSKY.body_length, HUSKY.body_height) == (length, height)
    assert HUSKY.body_width == pytest.approx(p["track"] - p["wheel_length"])
    assert HUSKY.clearance == pytest.approx(p["wheel_radius"] - p["wheel_vertical_offset"])


def test_husky_s_mass_and_inertia_are_the_sums_of_its_parts():
    assert HUSKY.body_mass == pytest.approx(PUBLIC["body_mass"])
    distance = np.hypot(PUBLIC["wheelbase"] / 2, PUBLIC["track"] / 2)
    upright = PUBLIC["wheel_inertia"][0] + PUBLIC["wheel_mass"] * distance**2
    assert HUSKY.inertia == pytest.approx(PUBLIC["body_inertia_zz"] + 4 * upright, abs=1e-3)


def test_husky_s_friction_is_the_printed_one():
    chosen = published.load("dangelo_2022_vehicle")["friction"]["chosen"]
    assert HUSKY.friction_longitudinal == HUSKY.friction_lateral == chosen


def test_every_number_has_a_symbol_a_unit_and_a_source():
    assert set(PROVENANCE) == {field.name for field in fields(Vehicle)}
    assert all(unit and source for _, unit, source in PROVENANCE.values())


def test_the_backhoe_as_a_vehicle_has_the_machine_s_numbers():
    vehicle, tracks = travel.BACKHOE_TRACKS, BACKHOE.tracks
    assert (vehicle.mass, vehicle.gravity) == (BACKHOE.mass, BACKHOE.gravity)
    assert vehicle.inertia == travel.yaw_inertia(travel.POSTURE, BACKHOE)[0]
    assert (vehicle.half_track, vehicle.wheel_radius) == (tracks.gauge / 2, tracks.sprocket_radius)
    assert 4 * vehicle.wheel_mass == 2 * tracks.belt_mass


def test_four_points_of_a_track_turn_as_heavily_as_its_whole_length():
    vehicle, tracks = travel.BACKHOE_TRACKS, BACKHOE.tracks
    x = (np.arange(100_000) + 0.5) / 100_000 * tracks.length - tracks.length / 2
    even = tracks.friction_lateral * vehicle.mass * vehicle.gravity * np.abs(x).mean()
    across = np.stack([np.zeros(4), 1e6 * vehicle.positions[:, 0]], axis=-1)
    force = skid_steer.contact_forces(across, vehicle)
    assert -vehicle.positions[:, 0] @ force[:, 1] == pytest.approx(even)


def test_the_wheels_carry_the_weight_without_tipping():
    vehicle = replace(HUSKY, front=0.2, rear=0.4)
    assert vehicle.loads.sum() == pytest.approx(vehicle.mass * vehicle.gravity)
    assert vehicle.loads @ vehicle.positions == pytest.approx([0.0, 0.0], abs=1e-12)
    assert HUSKY.loads == pytest.approx(np.full(4, HUSKY.mass * HUSKY.gravity / 4))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"mass": -1.0}, r"Vehicle\.mass must be one number above 0, got -1\.0"),
        ({"mass": float("nan")}, r"Vehicle\.mass must be .* got nan"),
        ({"mass": "50"}, r"Vehicle\.mass must be .* got '50'"),
        ({"mass": True}, r"Vehicle\.mass must be .* got True"),
        ({"rolling": -0.1}, r"Vehicle\.rolling must be one number at least 0"),
        ({"x_icr": np.inf}, r"Vehicle\.x_icr must be one finite number"),
        ({"mass": 10.0}, "4 x 2.637 kg leave nothing"),
        ({"x_icr": 0.3}, r"between the axles, in \(-0.256, 0.256\) m"),
    ],
)
def test_impossible_vehicles_are_refused(change, says):
    with pytest.raises(ValueError, match=says):
        replace(HUSKY, **change)


# Kinematics


def test_wheel_speeds_and_twist_undo_each_other(rng):
    twist = rng.normal(size=(50, 2))
    left, right = np.moveaxis(skid_steer.wheel_speeds(twist), -1, 0)
    assert skid_steer.body_twist(left, right) == pytest.approx(twist)


def test_22_is_the_rolling_of_each_wheel_s_contact_point(rng):
    for v, omega in rng.normal(size=(20, 2)):
        left, right = skid_steer.wheel_speeds([v, omega])
        slip = skid_steer.contact_velocity([v, 0.0, omega], [left, right, left, right])
        assert slip[:, 0] == pytest.approx(np.zeros(4), abs=1e-12)


def test_an_effective_half_track_asks_for_faster_wheels():
    left, right = skid_steer.wheel_speeds([0.0, 1.0], half_track=2 * HUSKY.half_track)
    assert skid_steer.body_twist(left, right)[1] == pytest.approx(2.0)
    assert skid_steer.body_twist(left, right, half_track=2 * HUSKY.half_track)[1] == pytest.approx(
        1
    )


def test_contact_velocity_is_the_derivative_of_the_contact_point(rng):
    velocity, wheels = rng.normal(size=3), rng.normal(size=4)
    dt = 1e-7
    for i, point in enumerate(HUSKY.positions):
        spin = np.exp(1j * velocity[2] * dt)
        moved = complex(*velocity[:2]) * dt + complex(*point) * spin - complex(*point)
        rolled = moved - HUSKY.wheel_radius * wheels[i] * dt
        slip = skid_steer.contact_velocity(velocity, wheels)[i]
        assert slip == pytest.approx([rolled.real / dt, rolled.imag / dt], abs=1e-6)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: skid_steer.wheel_speeds([1.0, 0.0, 0.0]), r"twist must end in 2 values"),
        (lambda: skid_steer.wheel_speeds([np.nan, 0.0]), "twist must be finite"),
        (lambda: skid_steer.wheel_speeds("go"), "twist must be numbers"),
        (lambda: skid_steer.wheel_speeds([1, 0], half_track=0.0), "half_track must be one number"),
        (lambda: skid_steer.body_twist([1, 2], 1.0), r"must be alike, got shapes \(2,\), \(\)"),
        (lambda: skid_steer.world_velocity(0.0, [1, 2]), "velocity must end in 3 values"),
        (lambda: skid_steer.pose_rate(np.inf, [1, 2]), "theta must be finite"),
        (lambda: skid_steer.contact_velocity([1, 0, 0], [1, 2]), "wheels must end in 4 speeds"),
    ],
)
def test_wrong_arguments_of_kinematics_are_named(call, says):
    with pytest.raises(ValueError, match=says):
        call()


# Friction


def test_the_slope_of_the_linear_law_is_the_derivative_of_the_smooth_one():
    v, k_s, mu = sp.symbols("v k_s mu", positive=True)
    derivative = sp.diff(mu * 2 / sp.pi * sp.atan(k_s * v), v).subs(v, 0)
    assert float(derivative.subs({k_s: 10, mu: 0.2})) == pytest.approx(skid_steer.slope(0.2, 10.0))
    h = 1e-6
    tangent = skid_steer.smooth(h, 50.0, 0.2, 10.0) / h
    assert skid_steer.linear(1.0, 50.0, 0.2, 10.0) == pytest.approx(tangent, rel=1e-6)


def test_at_1_m_s_with_k_s_10_the_linear_law_gives_almost_7_times_too_much():
    linear = skid_steer.linear(1.0, 100.0, 0.2, 10.0)
    smooth = skid_steer.smooth(1.0, 100.0, 0.2, 10.0)
    assert linear / smooth == pytest.approx(6.8, abs=0.01)
    assert skid_steer.overestimate(1.0, 10.0) == pytest.approx(linear / smooth)
    assert skid_steer.overestimate(0.0, 10.0) == 1.0


@pytest.mark.parametrize("error", [0.01, 0.1, 1.0])
def test_the_linear_law_holds_below_its_range_and_not_above(error):
    v = skid_steer.linear_range(10.0, error)
    assert skid_steer.overestimate(v, 10.0) == pytest.approx(1 + error)
    assert skid_steer.overestimate(1.01 * v, 10.0) > 1 + error


def test_where_one_law_resembles_the_smooth_one_the_other_does_not():
    k_s = 100.0
    linear_up_to = skid_steer.linear_range(k_s, 0.1)
    speeds = np.geomspace(1e-4, 1.0, 400)
    coulomb_from = speeds[skid_steer.smooth_sign(speeds, k_s) > 0.9][0]
    assert coulomb_from > 10 * linear_up_to


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: skid_steer.coulomb(1.0, -5.0, 0.2), "the ground does not pull"),
        (lambda: skid_steer.coulomb(np.nan, 5.0, 0.2), "must be finite"),
        (lambda: skid_steer.smooth(1.0, 5.0, -0.2, 10.0), "mu must be one number at least 0"),
        (lambda: skid_steer.smooth(1.0, 5.0, 0.2, 0.0), "k_s must be one number above 0"),
        (lambda: skid_steer.linear(1.0, 5.0, 0.2, np.inf), "k_s must be one number above 0"),
        (lambda: skid_steer.linear_range(10.0, 0.0), "error must be one number above 0"),
        (lambda: skid_steer.overestimate("fast", 10.0), "v must be numbers"),
    ],
)
def test_wrong_arguments_of_friction_are_named(call, says):
    with pytest.raises(ValueError, match=says):
        call()


# The linear model


def derived_accelerations():
    """Newton's law with each wheel's forces written out, nothing of the module's formulas."""
    m, inertia, r, c, a, b, g, k, k_x, k_y = sp.symbols("m I r c a b g K K_x K_y", positive=True)
    v, omega, u1, u2 = sp.symbols("v omega u1 u2", real=True)
    force, moment = 0, 0
    for x, y in ((a, c), (a, -c), (-b, c), (-b, -c)):
        load = m * g / 2 * (b if x == a else a) / (a + b)
        reference, speed = (u1 - y * u2) / r, (v - y * omega) / r
        push = k * (reference - speed) / r
        force += push - load * k_x * v
        moment += -y * push + x * (-load * k_y * x * omega)
    names = (m, inertia, r, c, a, b, g, k, k_x, k_y)
    return names, (v, omega, u1, u2), sp.simplify(force / m), sp.simplify(moment / inertia)


@pytest.mark.parametrize("vehicle", [HUSKY, replace(HUSKY, front=0.2, rear=0.35, lateral=0.4)])
def test_the_repaired_215_follows_from_newton_s_law_wheel_by_wheel(vehicle, rng):
    names, variables, dv, domega = derived_accelerations()
    p = vehicle
    numbers = (p.mass, p.inertia, p.wheel_radius, p.half_track, p.front, p.rear, p.gravity)
    numbers += (p.speed_gain, p.rolling, p.lateral)
    known = dict(zip(names, numbers, strict=True))
    A, B, _, _ = skid_steer.state_space(vehicle)
    for values in rng.normal(size=(5, 4)):
        given = known | dict(zip(variables, values, strict=True))
        found = A @ [0, values[0], 0, values[1]] + B @ values[2:]
        assert found[[1, 3]] == pytest.approx([float(dv.subs(given)), float(domega.subs(given))])


def test_the_repaired_model_keeps_its_meaning_in_any_units():
    other = in_units(HUSKY, kg=3.0, m=0.4, s=1.7)
    assert np.array(skid_steer.rates(other)) == pytest.approx(1.7 * np.array(skid_steer.rates()))
    assert skid_steer.radius(1.0 / 0.4 * 1.7, 0.5 * 1.7, other) == pytest.approx(
        skid_steer.radius(1.0, 0.5) / 0.4
    )


def test_the_units_of_the_provenance_are_those_of_the_scaling_test():
    named = {"kg": (1, 0, 0), "m": (0, 1, 0), "kg m^2": (1, 2, 0), "1": (0, 0, 0)}
    named |= {"s/m": (0, -1, 1), "N m s/rad": (1, 2, -1), "m/s^2": (0, 1, -2)}
    for field in fields(Vehicle):
        assert named[PROVENANCE[field.name][1]] == UNITS.get(field.name, (0, 1, 0))


def test_the_printed_steady_state_comes_out():
    printed = STEP["dynamic"]
    command = np.array([STEP["v_ref"], STEP["omega_ref"]])
    error = command - skid_steer.steady_state(*command)
    assert error == pytest.approx([printed["error_v"], printed["error_omega"]], abs=5e-5)
    radius = skid_steer.radius(*command)
    assert radius == pytest.approx(printed["radius"], abs=0.005)
    assert 100 * (radius / STEP["ideal_radius"] - 1) == pytest.approx(2.0, abs=0.5)


def test_only_two_ratios_can_be_inferred_from_the_steady_state():
    printed, command = STEP["dynamic"], (STEP["v_ref"], STEP["omega_ref"])
    errors = printed["error_v"], printed["error_omega"]
    ratio_v, ratio_omega = (e / (u - e) for e, u in zip(errors, command, strict=True))
    assert (ratio_v, ratio_omega) == pytest.approx((0.00705, 0.0267), abs=5e-5)
    other = replace(HUSKY, mass=70.0, inertia=5.0, speed_gain=30.0, wheel_radius=0.2)
    for start in (HUSKY, other):
        fitted = skid_steer.fit(*errors, *command, start)
        k = skid_steer.rates(fitted)
        assert k.drag_v / k.drive_v == pytest.approx(ratio_v)
        assert k.drag_omega / k.drive_omega == pytest.approx(ratio_omega)
        assert skid_steer.radius(*command, fitted) == pytest.approx(
            (1 - 0.007) / (0.5 - 0.013), rel=1e-12
        )


def test_the_printed_errors_ask_for_k_s_below_1_or_a_very_stiff_speed_control():
    """k_s >> 1 is the premise of (2.10): with it K_ptau is 18 times ours."""
    k_s = HUSKY.lateral / skid_steer.slope(HUSKY.friction_lateral, 1.0)
    assert k_s == pytest.approx(0.55, abs=0.01)
    steep = skid_steer.slope(HUSKY.friction_lateral, 10.0)
    assert HUSKY.speed_gain * steep / HUSKY.lateral == pytest.approx(145, abs=1)


def test_the_step_response_is_that_of_python_control():
    t = np.linspace(0, STEP["duration"], 400)
    system = control.ss(*skid_steer.state_space())
    inputs = np.repeat([[STEP["v_ref"]], [STEP["omega_ref"]]], len(t), axis=1)
    theirs = control.forced_response(system, t, inputs).outputs.T
    ours = skid_steer.step_response(t, STEP["v_ref"], STEP["omega_ref"])
    assert ours == pytest.approx(theirs, abs=1e-9)


def test_the_two_halves_of_the_model_do_not_touch_and_are_stable():
    A, B, C, D = skid_steer.state_space()
    assert not A[:2, 2:].any()
    assert not A[2:, :2].any()
    assert not B[[0, 1, 2, 3], [1, 1, 0, 0]].any()
    assert np.array_equal(C, np.eye(4))
    assert not D.any()
    k = skid_steer.rates()
    poles = [0.0, 0.0, -(k.drive_v + k.drag_v), -(k.drive_omega + k.drag_omega)]
    assert np.sort(np.linalg.eigvals(A)) == pytest.approx(np.sort(poles))


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: skid_steer.radius(1.0, 0.0), "a straight line"),
        (lambda: skid_steer.steady_state(np.nan, 0.0), "v_ref must be finite"),
        (lambda: skid_steer.step_response([-1.0], 1.0, 0.5), "t must not be negative"),
        (lambda: skid_steer.fit(1.2, 0.1, 1.0, 0.5), "error_v must lie between 0"),
        (lambda: skid_steer.fit(0.1, 0.1, 1.0, 0.0), "error_omega must lie between 0"),
        (lambda: skid_steer.fit(0.1, -0.1, 1.0, 0.5), "error_omega must lie between 0"),
    ],
)
def test_wrong_arguments_of_the_linear_model_are_named(call, says):
    with pytest.raises(ValueError, match=says):
        call()
