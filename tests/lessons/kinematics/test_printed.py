"""Which entries of the thesis's printed kinematics hold, found against the library's own."""

import numpy as np
import pytest
from scipy.optimize import brentq

from backhoe.arm import kinematics
from backhoe.lessons import published
from backhoe.lessons.kinematics import printed
from backhoe.machine import BACKHOE, replace

FRAMES = ("swing", "boom", "stick", "tip")


@pytest.fixture
def rng():
    return np.random.default_rng(11)


@pytest.fixture
def q(rng):
    return rng.uniform(-np.pi, np.pi, (200, 4))


def wrong_entries(print_, right):
    """(row, column) counted from 1 of the entries that differ in some posture."""
    wrong = np.abs(print_ - right).max(axis=0) > 1e-9
    return {(int(row) + 1, int(column) + 1) for row, column in np.argwhere(wrong)}


@pytest.mark.parametrize(
    "link, wrong",
    [(0, set()), (1, set()), (2, {(1, 2), (1, 3), (2, 3), (3, 2)}), (3, {(1, 3), (2, 3)})],
)
def test_a15_is_wrong_in_six_entries_of_its_last_two_matrices(q, link, wrong):
    right = kinematics.link_transforms(q)[:, link]
    assert wrong_entries(printed.link_transforms(q)[:, link], right) == wrong


def test_printed_t3_is_not_a_rotation(q):
    R = printed.link_transforms(q)[:, 2, :3, :3]
    assert np.abs(R @ np.swapaxes(R, 1, 2) - np.eye(3)).max() > 0.5


@pytest.mark.parametrize(
    "link, wrong",
    [
        (0, set()),
        (1, set()),
        (2, {(row, 3) for row in (1, 2, 3)}),
        (3, {(row, column) for row in (1, 2, 3) for column in (3, 4)}),
    ],
)
def test_a18_turns_stick_and_bucket_about_the_wrong_axis(q, link, wrong):
    right = kinematics.jacobian(q, FRAMES[link])[:, 3:]
    assert wrong_entries(printed.angular_jacobians(q)[:, link], right) == wrong


def test_a17_has_one_matrix_that_is_the_jacobian_of_a_point(q):
    points = ("swing", "swing_com", "boom", "boom_com", "stick", "stick_com", "tip", "bucket_com")
    right = {name: kinematics.jacobian(q, name)[:, :3] for name in points}
    J = printed.linear_jacobians(q)
    fits = {
        (link + 1, name)
        for link in range(4)
        for name in points
        if not wrong_entries(J[:, link], right[name])
    }
    assert fits == {(1, "swing")}


def test_a17_boom_becomes_right_with_l_cm2_and_without_b0(q):
    boom = replace(BACKHOE.boom, length=BACKHOE.boom.com_radius)
    mended = replace(BACKHOE, boom=boom, base=replace(BACKHOE.base, offset=0.0))
    right = kinematics.jacobian(q, "boom_com")[:, :3]
    assert not wrong_entries(printed.linear_jacobians(q, mended)[:, 1], right)


def test_24_has_unbounded_gain_where_damped_least_squares_stays_below_its_bound():
    damping = 0.1

    def shifted(stick):
        J = kinematics.task_jacobian(np.array([-np.pi / 2, 0.3, stick, 0.0]))
        return np.linalg.det(J + damping**2 * np.eye(4))

    near_stretched = brentq(shifted, np.radians(80), np.radians(95), xtol=1e-15)
    J = kinematics.task_jacobian(np.array([-np.pi / 2, 0.3, near_stretched, 0.0]))
    gain = np.linalg.norm(printed.inverse_24(J, damping), 2)
    dls = np.linalg.norm(J.T @ np.linalg.inv(J @ J.T + damping**2 * np.eye(4)), 2)
    assert gain > 1e6 and dls <= 0.5 / damping + 1e-12


def test_the_three_members_of_25_are_three_different_matrices(rng):
    damping = 0.05
    J = kinematics.task_jacobian(rng.uniform(BACKHOE.lower, BACKHOE.upper, 4))
    U, sigma, Vt = np.linalg.svd(J)
    right_side = (Vt.T * (sigma / (sigma**2 + damping**2))) @ U.T
    left, middle = printed.inverse_24(J, damping), printed.inverse_25(J, damping)
    dls = J.T @ np.linalg.inv(J @ J.T + damping**2 * np.eye(4))
    np.testing.assert_allclose(right_side, dls, atol=1e-12)
    assert np.abs(left - middle).max() > 1e-4
    assert np.abs(left - right_side).max() > 1e-4
    assert np.abs(middle - right_side).max() > 1e-4


def test_24_needs_a_square_jacobian(rng):
    J = kinematics.jacobian(np.zeros(4))
    for inverse in (printed.inverse_24, printed.inverse_25):
        with pytest.raises(ValueError, match=r"must be square, got shape \(6, 4\)"):
            inverse(J, 0.1)


def test_210_stands_still_when_both_sprockets_turn_alike(rng):
    heading = rng.uniform(-np.pi, np.pi, 50)
    np.testing.assert_array_equal(printed.track_matrix(heading) @ (1.0, 1.0), 0.0)


def test_210_has_every_entry_wrong(rng):
    heading = rng.uniform(-np.pi, np.pi, 50)
    r, gauge = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge
    forward = np.stack((np.cos(heading), np.sin(heading)), axis=-1) * r / 2
    right = np.empty((50, 3, 2))
    right[:, :2, 0] = right[:, :2, 1] = forward
    right[:, 2] = r / gauge, -r / gauge
    assert len(wrong_entries(printed.track_matrix(heading), right)) == 6


def test_table_a2_holds_every_length_and_angle_of_the_machine():
    table = published.load("mastalli_2013_table_a2")
    flat = {name: entry for group in table.values() if isinstance(group, dict)
            for name, entry in group.items()}  # fmt: skip
    assert (flat["L_0"], flat["b_0"]) == (BACKHOE.base.height, BACKHOE.base.offset)
    assert (flat["L_1"], flat["b_1"]) == (BACKHOE.swing.height, BACKHOE.swing.offset)
    lengths = tuple(link.length for link in BACKHOE.links)
    assert (flat["L_2"], flat["L_3"], flat["L_4"]) == lengths
    printed_angles = np.array([flat["theta_2"], flat["theta_3"], flat["theta_4"]])
    offsets = np.degrees([link.angle_offset for link in BACKHOE.links])
    np.testing.assert_allclose(offsets, printed_angles * (1, -1, -1))


def test_table_a1_as_printed_straightens_the_arm_that_should_hang():
    table = published.load("mastalli_2013_table_a1")
    angles = published.load("mastalli_2013_table_a2")
    constant = {row["link"]: row.get("constant_deg", 0.0) for row in table["rows"]}
    theta = {name: value for group in angles.values() if isinstance(group, dict)
             for name, value in group.items() if name.startswith("theta")}  # fmt: skip
    stick_as_printed = constant[3] + theta["theta_3"]
    assert abs(stick_as_printed) < 2.0
    assert np.degrees(BACKHOE.stick.angle_offset) < -85.0


def test_bad_q_is_named():
    for formula in (printed.link_transforms, printed.linear_jacobians, printed.angular_jacobians):
        with pytest.raises(ValueError, match="4 joints"):
            formula([0.0, 0.0, 0.0])
