"""Jacobians of robots on wheels and tracks, from the velocities at the contacts."""

import numpy as np
import pytest
import sympy as sp

from backhoe.localisation import odometry
from backhoe.machine import BACKHOE, replace
from backhoe.vehicle import skid_steer, travel
from backhoe.vehicle.tracks import tracks_twist

ROBOTS = {
    "differential": odometry.differential(0.1, 0.5),
    "tracks": odometry.tracks(),
    "three": odometry.omni(0.05, 0.2, first=0.3),
    "four": odometry.omni(0.05, 0.2, 4),
    "mecanum": odometry.mecanum(0.1, 0.25, 0.2),
    "mecanum, 30 deg": odometry.mecanum(0.1, 0.25, 0.2, np.pi / 6),
}
VELOCITY = np.array([0.7, -0.4, 0.9])


def contact(place, velocity=VELOCITY):
    """Velocity of a point of the body over the ground."""
    v_x, v_y, omega = velocity
    return np.array([v_x - omega * place[1], v_y + omega * place[0]])


def test_tracks_and_differential_wheels_roll_as_fast_as_the_ground_passes_under_them():
    speeds = ROBOTS["differential"].wheel_speeds(VELOCITY)
    for speed, y in zip(speeds, (0.25, -0.25), strict=True):
        assert 0.1 * speed == pytest.approx(contact((0, y))[0])


@pytest.mark.parametrize(("name", "first", "count"), [("three", 0.3, 3), ("four", 0.0, 4)])
def test_omnidirectional_wheels_roll_along_the_ring_and_slide_across_it(name, first, count):
    speeds = ROBOTS[name].wheel_speeds(VELOCITY)
    for i in range(count):
        angle = first + 2 * np.pi * i / count
        along = np.array([-np.sin(angle), np.cos(angle)])
        place = 0.2 * np.array([np.cos(angle), np.sin(angle)])
        assert 0.05 * speeds[i] == pytest.approx(along @ contact(place))


@pytest.mark.parametrize(
    ("name", "angle"), [("mecanum", np.pi / 4), ("mecanum, 30 deg", np.pi / 6)]
)
def test_a_mecanum_wheel_slips_only_across_the_axis_of_its_roller(name, angle):
    speeds = ROBOTS[name].wheel_speeds(VELOCITY)
    places, leans = [(0.25, 0.2), (0.25, -0.2), (-0.25, 0.2), (-0.25, -0.2)], [-1, 1, 1, -1]
    for speed, place, lean in zip(speeds, places, leans, strict=True):
        axis = np.array([np.cos(angle), lean * np.sin(angle)])
        slip = contact(place) - [0.1 * speed, 0]
        assert axis @ slip == pytest.approx(0, abs=1e-15)


def test_the_mecanum_matrix_is_the_one_of_the_textbooks():
    robot = odometry.mecanum(0.1, 0.25, 0.2)
    expected = 0.1 / 4 * np.array([[1, 1, 1, 1], [-1, 1, 1, -1], np.array([-1, 1, -1, 1]) / 0.45])
    np.testing.assert_allclose(robot.body, expected, atol=1e-16)


def test_the_textbook_matrices_by_sympy():
    r, d = sp.Rational(1, 20), sp.Rational(1, 5)
    angles = [sp.Rational(2, 3) * sp.pi * i for i in range(3)]
    W = sp.Matrix([[-sp.sin(a), sp.cos(a), d] for a in angles]) / r
    np.testing.assert_allclose(
        odometry.omni(0.05, 0.2).body, np.array(W.inv(), dtype=float), atol=1e-16
    )
    gauge, radius = sp.symbols("b r", positive=True)
    psi = sp.Symbol("psi")
    turn = sp.Matrix([[sp.cos(psi), 0], [sp.sin(psi), 0], [0, 1]])
    J = turn * sp.Matrix([[radius / 2, radius / 2], [-radius / gauge, radius / gauge]])
    numbers = {radius: 0.1, gauge: 0.5, psi: 0.7}
    np.testing.assert_allclose(
        ROBOTS["differential"].jacobian(0.7), np.array(J.subs(numbers), dtype=float), atol=1e-16
    )


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_wheels_tell_the_velocity_that_drove_them(robot):
    velocity = VELOCITY * [1, 0, 1] if len(robot.wheels) == 2 else VELOCITY
    np.testing.assert_allclose(robot.velocity(robot.wheel_speeds(velocity)), velocity, atol=1e-14)
    np.testing.assert_allclose(robot.unexplained(robot.wheel_speeds(velocity)), 0, atol=1e-13)


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_the_rate_is_the_velocity_turned_by_the_heading(robot):
    u = np.random.default_rng(1).normal(size=(5, len(robot.wheels)))
    pose = np.random.default_rng(2).normal(size=(5, 3))
    v_x, v_y, omega = robot.velocity(u).T
    direction = np.exp(1j * pose[:, 2])
    moved = (v_x + 1j * v_y) * direction
    np.testing.assert_allclose(
        robot.rate(pose, u), np.stack([moved.real, moved.imag, omega], axis=-1), atol=1e-14
    )
    np.testing.assert_allclose(
        robot.jacobian(pose[:, 2])[3] @ u[3], robot.rate(pose[3], u[3]), atol=1e-14
    )


def test_four_wheels_that_fight_show_it():
    robot = ROBOTS["mecanum"]
    fight = np.array([1.0, 1.0, -1.0, -1.0])
    np.testing.assert_allclose(robot.velocity(fight), 0, atol=1e-15)
    np.testing.assert_allclose(robot.unexplained(fight), fight, atol=1e-15)
    assert np.linalg.matrix_rank(np.eye(4) - robot.rolling @ robot.body) == 1


def test_tracks_are_the_kinematics_of_the_lessons_before():
    left, right = np.random.default_rng(3).normal(size=(2, 9))
    expected = skid_steer.body_twist(left, right, travel.BACKHOE_TRACKS)
    np.testing.assert_allclose(np.stack(tracks_twist(left, right), -1), expected, rtol=1e-12)
    velocity = odometry.tracks().velocity(np.stack([left, right], axis=-1))
    np.testing.assert_allclose(velocity[:, [0, 2]], expected, rtol=1e-12)


def test_slip_is_the_share_of_the_way_that_the_ground_does_not_see():
    v, omega = tracks_twist(2.0, 3.0, slip=(0.1, 0.25))
    belt = BACKHOE.tracks.sprocket_radius * np.array([2.0 * 0.9, 3.0 * 0.75])
    assert v == pytest.approx(belt.mean())
    assert omega == pytest.approx((belt[1] - belt[0]) / BACKHOE.tracks.gauge)


def test_an_effective_gauge_makes_turns_shorter_and_leaves_the_way():
    v, omega = tracks_twist(1.0, 2.0)
    v_long, omega_long = tracks_twist(1.0, 2.0, gauge=2 * BACKHOE.tracks.gauge)
    assert (v_long, omega_long) == (pytest.approx(v), pytest.approx(omega / 2))
    wide = replace(BACKHOE, tracks=replace(BACKHOE.tracks, gauge=2 * BACKHOE.tracks.gauge))
    assert tracks_twist(1.0, 2.0, wide)[1] == pytest.approx(omega / 2)
    np.testing.assert_allclose(
        odometry.tracks(gauge=wide.tracks.gauge).body, odometry.tracks(wide).body, rtol=1e-14
    )


def test_odometry_from_angles_is_that_from_speeds():
    rng = np.random.default_rng(4)
    left, right = rng.normal(size=(2, 3, 40))
    angles = [
        np.concatenate([np.full((3, 1), 7.0), 7 + np.cumsum(w, -1)], -1) for w in (left, right)
    ]
    v, omega = tracks_twist(left, right)
    np.testing.assert_allclose(
        odometry.from_angles([1, 2, 3], *angles),
        odometry.integrate([1, 2, 3], v, omega, 1.0),
        atol=1e-12,
    )


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: odometry.differential(0, 1), r"radius must be one number above 0 \[m\], got 0"),
        (lambda: odometry.differential(0.1, -1), "gauge must be one number above 0"),
        (lambda: odometry.omni(0.1, 0.2, 2), "count must be one whole number at least 3, got 2"),
        (lambda: odometry.omni(0.1, 0.2, 3.0), "count must be one whole number"),
        (
            lambda: odometry.mecanum(0.1, 0.2, 0.2, 0.0),
            "roller_angle must be one number above 0 and below 1.5708",
        ),
        (lambda: odometry.tracks(gauge="wide"), "gauge must be one number above 0"),
        (lambda: ROBOTS["three"].rate([0, 0, 0], [1, 2]), "u must end in 3 values"),
        (lambda: ROBOTS["three"].jacobian(np.nan), "psi must be finite"),
        (lambda: tracks_twist([1, 2], [1]), "left and right must be alike"),
        (lambda: tracks_twist(1, 1, slip=(0, 1)), "two shares below 1"),
        (lambda: tracks_twist(1, 1, slip=0.1), "two shares below 1"),
        (lambda: odometry.Wheels(0.1, 0.0, 1.0), "Wheels.right must be one number above 0"),
        (lambda: odometry.from_angles(np.zeros(3), [1.0], [1.0]), "2 or more readings"),
        (lambda: odometry.from_angles(np.zeros(3), [1, 2], [1, 2, 3]), "must be alike"),
    ],
)
def test_bad_robots_and_speeds_are_named(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_the_matrices_of_a_robot_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        ROBOTS["three"].body[0, 0] = 1.0
