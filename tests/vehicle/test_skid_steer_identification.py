"""Identifying how a vehicle turns from encoders and poses, and (2.7) as printed."""

import numpy as np
import pytest

from backhoe.lessons.skid_steer import printed
from backhoe.vehicle import skid_steer
from backhoe.vehicle.skid_steer import HUSKY, identify, replace, simulate

DT = 0.02


def rolling_log(half_track=0.3, x_icr=0.12, seconds=10.0, scale=1.0):
    """A vehicle that turns as if its half track were `half_track`: known truth."""
    t = DT * np.arange(round(seconds / DT))
    v, omega = 0.6 + 0.3 * np.sin(0.7 * t), 0.8 * np.sin(0.5 * t)
    true = replace(HUSKY, x_icr=x_icr, half_track=half_track)
    run = simulate(v, omega, DT, true, model="kinematic")
    left, right = skid_steer.wheel_speeds(np.stack([v / scale, omega], -1), true).T
    # What held over a sample, as a log whose trapezoid is exact: two entries a sample.
    time = np.repeat(run.time, 2)[1:-1] + np.tile([0.0, -1e-9], len(v))
    pose = np.repeat(run.pose, 2, axis=0)[1:-1]
    return time, np.repeat(left, 2), np.repeat(right, 2), pose


def turn_in_place(x_icr=0.12, half_track=0.3):
    n = 500
    true = replace(HUSKY, x_icr=x_icr, half_track=half_track)
    run = simulate(np.zeros(n), np.ones(n), DT, true, model="kinematic")
    wheels = run.wheels[1:]
    return run.time[1:], wheels[:, 0], wheels[:, 1], run.pose[1:]


def test_27_as_printed_gives_no_length_and_times_r_the_half_track_not_x_icr():
    time, left, right, pose = turn_in_place(x_icr=0.12, half_track=0.3)
    turn = pose[-1, 2] - pose[0, 2]
    as_printed = printed.x_icr_27(time, left, right, turn)
    assert as_printed == pytest.approx(0.3 / HUSKY.wheel_radius)
    assert as_printed == pytest.approx(1.817, abs=1e-3)  # against x_icr = 0.12 m
    corrected = skid_steer.effective_half_track(time, left, right, turn)
    assert corrected == pytest.approx(0.3)


def test_turning_in_place_x_icr_is_the_radius_of_the_centre_of_mass_s_circle():
    log = turn_in_place(x_icr=0.12)
    found = identify(*log)
    x, y = log[3][:, 0], log[3][:, 1]
    assert found.x_icr == pytest.approx(0.12, abs=1e-6)
    assert found.x_icr == pytest.approx((x.max() - x.min()) / 2, abs=1e-4)
    assert found.x_icr == pytest.approx((y.max() - y.min()) / 2, abs=1e-4)
    assert np.isnan(found.path_scale)


@pytest.mark.parametrize(("half_track", "x_icr"), [(0.3, 0.12), (0.5, -0.05)])
def test_known_numbers_are_found_from_a_path_that_winds(half_track, x_icr):
    found = identify(*rolling_log(half_track, x_icr))
    assert found.half_track == pytest.approx(half_track, rel=1e-6)
    assert found.x_icr == pytest.approx(x_icr, abs=1e-3)
    assert found.path_scale == pytest.approx(1.0, abs=1e-3)
    assert found.ratio == pytest.approx(half_track / HUSKY.half_track, rel=1e-6)
    assert found.turn_residual < 1e-6


def test_wheels_that_slip_along_show_in_the_scale_of_the_path():
    found = identify(*rolling_log(scale=0.9))
    assert found.path_scale == pytest.approx(0.9, abs=1e-3)


def test_the_slipping_vehicle_shows_the_half_track_of_the_closed_form():
    n = 1000
    run = simulate(np.zeros(n), np.full(n, 0.8), DT)
    found = identify(run.time, run.wheels[:, 0], run.wheels[:, 1], run.pose)
    assert found.half_track == pytest.approx(skid_steer.turning_half_track(HUSKY), rel=2e-3)
    assert abs(found.x_icr) < 1e-6


def test_on_a_winding_path_the_slipping_vehicle_fits_no_two_numbers_and_the_residual_says_so():
    """Slip depends on speed and curve: the best constants leave some hundredths of a radian."""
    t = DT * np.arange(1500)
    v, omega = 0.4 + 0.3 * np.sin(0.7 * t), 1.2 * np.sin(0.5 * t)
    run = simulate(v, omega, DT)
    found = identify(run.time, run.wheels[:, 0], run.wheels[:, 1], run.pose)
    assert HUSKY.half_track < found.half_track < skid_steer.turning_half_track(HUSKY)
    assert found.turn_residual > 100 * identify(*rolling_log()).turn_residual
    straight = skid_steer.body_twist(run.wheels[:, 0], run.wheels[:, 1])[:, 1]
    naive = np.cumsum(straight) * DT - run.pose[:, 2]
    assert found.turn_residual < 0.5 * np.std(naive)


@pytest.mark.parametrize(
    ("name", "true", "noise"),
    [("half_track", 0.5, [0.0, 0.0, 0.01]), ("x_icr", 0.1, [0.005, 0.005, 0.0])],
)
def test_the_standard_deviations_are_those_of_repeated_noise(name, true, noise):
    rng = np.random.default_rng(8)
    time, left, right, pose = rolling_log(0.5, 0.1)
    found = [
        identify(time, left, right, pose + rng.normal(0, noise, pose.shape)) for _ in range(200)
    ]
    values = np.array([getattr(one, name) for one in found])
    stated = np.mean([getattr(one, f"{name}_std") for one in found])
    assert values.std() == pytest.approx(stated, rel=0.15)
    assert values.mean() == pytest.approx(true, abs=0.5 * stated)


def test_the_path_s_residual_is_the_noise_of_the_position():
    rng = np.random.default_rng(9)
    time, left, right, pose = rolling_log()
    pose = pose + rng.normal(0, [0.01, 0.01, 0.0], pose.shape)
    found = identify(time, left, right, pose)
    assert found.path_residual == pytest.approx(0.01 * np.sqrt(2), rel=0.1)


ROW = np.linspace(0, 1, 5)
POSE = np.stack([ROW, ROW, ROW], axis=-1)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: identify(ROW[::-1], ROW, ROW, POSE), "time must rise: 1.0 s at index 0"),
        (lambda: identify(ROW[:2], ROW[:2], ROW[:2], POSE[:2]), "a row of 3 or more times"),
        (
            lambda: identify(ROW, ROW[:4], ROW, POSE),
            r"left must have shape \(5,\), got shape \(4,\)",
        ),
        (lambda: identify(ROW, ROW * np.nan, ROW, POSE), "left must be finite"),
        (
            lambda: identify(ROW, ROW, ROW, POSE[:, :2]),
            r"pose must be rows X, Y, theta, shape \(5, 3\)",
        ),
        (lambda: identify(ROW, ROW, ROW, POSE * [1, 1, 5 * np.pi]), "unwrap it first"),
        (lambda: identify(ROW, ROW, ROW, POSE * [1, 1, 0]), "must turn by at least 0.1 rad"),
        (lambda: identify(ROW, ROW, ROW, POSE), "does not tell the parameters apart"),
        (
            lambda: skid_steer.effective_half_track(ROW, -ROW, ROW, 0.0),
            "turn must be at least 0.1 rad",
        ),
        (lambda: skid_steer.effective_half_track(ROW, "x", ROW, 1.0), "left must be numbers"),
    ],
)
def test_logs_that_say_nothing_are_refused(call, says):
    with pytest.raises(ValueError, match=says):
        call()
