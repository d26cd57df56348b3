"""What lesson 01 claims in words."""

import numpy as np
import pytest
from scipy.optimize import minimize

from backhoe import mission
from backhoe.arm import kinematics
from backhoe.lessons.kinematics import printed
from backhoe.lessons.kinematics.exercises import posture
from backhoe.machine import BACKHOE, replace

LOWER, UPPER = BACKHOE.lower, BACKHOE.upper
L2, L3 = BACKHOE.boom.length, BACKHOE.stick.length
RNG = np.random.default_rng(1)
Q = RNG.uniform(LOWER, UPPER, (20_000, 4))
DIG, TARGET = np.radians([-90.0, 15.0, -10.0, 40.0]), [5.5, 1.2, 1.8, np.radians(30.0)]


GRID = np.stack(np.meshgrid(0, *np.linspace(LOWER, UPPER, 41).T[1:]), axis=-1).reshape(-1, 4)


def depth_under_a_track(aside_deg):
    """How deep teeth get below the shoes with the arm so far from straight ahead, 0 if nowhere."""
    swing = np.radians(aside_deg) - np.pi / 2
    x, y, z = kinematics.forward_kinematics(GRID + np.array([swing, 0, 0, 0]))[:, :3, 3].T
    feet = BACKHOE.tracks
    under = np.abs(x) < feet.length / 2
    under &= np.abs(np.abs(y) - feet.gauge / 2) < feet.shoe_width / 2
    return (-z[under]).max(initial=0.0)


def test_boom_stick_and_bucket_lie_in_one_vertical_plane():
    q = RNG.uniform(-7, 7, (1000, 4))
    across = np.stack((np.cos(q[:, 0]), np.sin(q[:, 0]), 0 * q[:, 0]), axis=-1)
    for frame in kinematics.FRAMES[:4]:
        place = kinematics.forward_kinematics(q, frame)[:, :3, 3] - (BACKHOE.base.offset, 0, 0)
        np.testing.assert_allclose(np.sum(place * across, axis=1), 0, atol=1e-12)


@pytest.mark.parametrize("aside", range(35, 156, 5))
def test_from_35_to_155_degrees_aside_the_teeth_dig_under_a_track(aside):
    assert depth_under_a_track(aside) > 2.5 and depth_under_a_track(-aside) > 2.5


def test_straight_ahead_and_straight_behind_they_dig_between_the_tracks():
    assert not [aside for aside in (-30, 0, 30, 160, 180) if depth_under_a_track(aside)]
    x = BACKHOE.base.offset + kinematics.forward_kinematics(GRID)[:, 1, 3]
    assert x.min() < BACKHOE.tracks.length / 2


def test_thirty_angles_a_joint_find_the_depth_of_any_machine():
    for machine in (posture._other_machine(RNG, place % 7) for place in range(20)):
        grid = np.meshgrid(*np.linspace(machine.lower, machine.upper, 30).T[1:], indexing="ij")
        q = np.stack((0 * grid[0], *grid), axis=-1)
        found = -kinematics.forward_kinematics(q, machine=machine)[..., 2, 3].min()
        assert abs(found - posture.dig_depth(machine)) < 0.01


def test_no_posture_within_the_limits_is_singular():
    """The least |det J| over the box, by an optimiser from many starts."""

    def size(q):
        return abs(np.linalg.det(kinematics.task_jacobian([0, *q, 0])))

    box = list(zip(LOWER[1:3], UPPER[1:3], strict=True))
    least = min(minimize(size, q[1:3], bounds=box).fun for q in Q[:20])
    assert least == pytest.approx(14, abs=0.5)


def test_the_limits_of_the_stick_leave_elbow_up_alone_and_a_ring_for_the_pin():
    bend = np.degrees(np.array([LOWER[2], UPPER[2]]) + BACKHOE.stick.angle_offset)
    np.testing.assert_allclose(bend, (-148.1, -28.1))
    d = np.sqrt(L2**2 + L3**2 + 2 * L2 * L3 * np.cos(np.radians(bend)))
    np.testing.assert_allclose(d, (3.64, 6.87), atol=0.005)
    np.testing.assert_allclose((L2 - L3, L2 + L3), (3.21, 7.04), atol=0.005)


def test_below_the_inner_radius_the_cosine_of_the_triangle_falls_below_minus_one():
    for d, outside in ((3.2, True), (3.22, False), (7.03, False), (7.05, True)):
        assert (abs((d**2 - L2**2 - L3**2) / (2 * L2 * L3)) > 1) == outside


def iterate(damping, steps):
    q, errors = DIG, []
    for _ in range(steps):
        error = TARGET - kinematics.pose(q)
        errors.append(np.linalg.norm(error))
        q = q + kinematics.damped_inverse(kinematics.task_jacobian(q), damping) @ error
    return np.array(errors)


def test_without_damping_the_number_of_right_digits_doubles_and_with_it_a_factor_stays():
    digits = -np.log10(iterate(0.0, 5)[1:])
    assert (digits[1:] / digits[:-1]).min() > 1.7
    shrinks = iterate(1.0, 30)[20:]
    np.testing.assert_allclose(shrinks[1:] / shrinks[:-1], shrinks[1] / shrinks[0], rtol=0.02)


def test_24_moves_the_singularity_by_a_fraction_of_a_degree():
    stretched = np.degrees(-BACKHOE.stick.angle_offset)
    stick = np.linspace(stretched - 1, stretched + 1, 2001)
    for boom in (-50, -20, 10, 40, 60):
        q = np.radians(np.stack([0 * stick - 90, 0 * stick + boom, stick, 0 * stick], axis=-1))
        gain = np.linalg.norm(printed.inverse_24(kinematics.task_jacobian(q), 0.1), 2, axis=(1, 2))
        assert gain.max() > 500 and 0.01 < abs(stick[gain.argmax()] - stretched) < 0.5


def test_more_than_a_quarter_of_the_iterations_end_outside_the_limits_nearly_all_elbow_down():
    solved = kinematics.solve_damped(kinematics.pose(Q[:200]), np.radians([0.0, 15.0, 0.0, 0.0]))
    outside = ~((solved.q >= LOWER) & (solved.q <= UPPER)).all(axis=1)
    assert 0.25 < outside[solved.converged].mean() < 0.33 and solved.converged.mean() > 0.98
    bend = solved.q[outside & solved.converged, 2] + BACKHOE.stick.angle_offset
    assert (np.sin(bend) > 0).mean() > 0.95


def test_arctan_turns_half_of_all_targets_behind_the_machine():
    x, y = kinematics.pose(Q)[:, :2].T - np.array([[BACKHOE.base.offset], [0]])
    wrong = np.abs(np.arctan(y / x) - np.arctan2(y, x)) > 1
    assert wrong.mean() == pytest.approx(0.5, abs=0.02)


def test_one_degree_of_the_boom_is_15_cm_at_the_teeth_of_the_stretched_arm():
    reach = sum(link.length for link in BACKHOE.links)
    assert np.radians(1) * reach == pytest.approx(0.15, abs=0.005)


def test_without_b0_the_bucket_reaches_40_cm_too_far():
    at_the_origin = replace(BACKHOE, base=replace(BACKHOE.base, offset=0.0))
    q = kinematics.inverse_kinematics([6.7, 0.0, 4.2, 1.0], machine=at_the_origin, limits=False)
    np.testing.assert_allclose(kinematics.pose(q), [7.1, 0.0, 4.2, 1.0], atol=0.01)


def test_a_plain_arctangent_tips_on_the_wrong_side_of_the_machine():
    targets = np.array([p.target for p in mission.hand_made_plan(0, over_truck=(1.6, -5.5, 3.9))])
    q = kinematics.inverse_kinematics(targets)
    with np.errstate(divide="ignore"):
        q[:, 0] = np.arctan(-(targets[:, 0] - BACKHOE.base.offset) / targets[:, 1])
    off = np.linalg.norm(kinematics.pose(q)[:, :3] - targets[:, :3], axis=1)
    assert off.mean() == pytest.approx(4.2, abs=0.1)
    assert (kinematics.pose(q)[off > 1, 1] > 5).all() and (targets[off > 1, 1] < -5).all()
