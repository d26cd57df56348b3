"""Kinematics: frames, Jacobians, inverse kinematics both ways, and the tracks."""

import subprocess
import sys

import numpy as np
import pytest

import oracles
from backhoe.arm import kinematics
from backhoe.machine import BACKHOE, replace

LONG_STICK = replace(BACKHOE, stick=replace(BACKHOE.stick, length=2.5))
FORWARD = -np.pi / 2


@pytest.fixture
def rng():
    return np.random.default_rng(11)


@pytest.fixture
def postures(rng):
    return rng.uniform(BACKHOE.lower, BACKHOE.upper, (300, 4))


def table_a1(q, machine):
    """T_01 to T_04 as products of the rows of Table A.1."""
    base, swing = machine.base, machine.swing
    dh = kinematics.dh_transform
    T = dh(0, base.height, base.offset, 0) @ dh(
        q[..., 0] + np.pi / 2, swing.height, swing.offset, np.pi / 2
    )
    frames = [T]
    for body, angle in zip(machine.links, np.moveaxis(q, -1, 0)[1:], strict=True):
        T = T @ dh(angle + body.angle_offset, 0, body.length, 0)
        frames.append(T)
    return np.stack(frames, axis=-3)


def turn_rate(T_before, T_after, dt):
    """Angular velocity between two close rotations, in the base frame."""
    S = (T_after - T_before)[..., :3, :3] / dt @ np.swapaxes(T_before[..., :3, :3], -1, -2)
    return np.stack([S[..., 2, 1], S[..., 0, 2], S[..., 1, 0]], axis=-1)


def test_dh_transform_is_turn_lift_go_twist():
    theta, d, a, alpha = 0.3, 0.5, 0.7, -1.1
    turn, go, twist = np.eye(4), np.eye(4), np.eye(4)
    turn[:2, :2] = [[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]]
    go[:3, 3] = a, 0, d
    twist[1:3, 1:3] = [[np.cos(alpha), -np.sin(alpha)], [np.sin(alpha), np.cos(alpha)]]
    np.testing.assert_allclose(
        kinematics.dh_transform(theta, d, a, alpha), turn @ go @ twist, atol=1e-15
    )


@pytest.mark.parametrize("machine", [BACKHOE, LONG_STICK], ids=["backhoe", "long stick"])
def test_link_transforms_are_the_products_of_the_denavit_hartenberg_rows(postures, machine):
    np.testing.assert_allclose(
        kinematics.link_transforms(postures, machine), table_a1(postures, machine), atol=1e-13
    )


@pytest.mark.parametrize("frame", ["swing", "boom", "stick", "tip"])
def test_forward_kinematics_picks_the_link_transform_of_the_frame(postures, frame):
    index = kinematics.FRAMES.index(frame)
    np.testing.assert_array_equal(
        kinematics.forward_kinematics(postures, frame),
        kinematics.link_transforms(postures)[:, index],
    )


def test_centres_of_mass_lie_at_their_radius_and_angle_from_the_joint(postures):
    """In the arm's plane as complex numbers; a link's angle counts from the link before it."""
    place = BACKHOE.swing.offset + 1j * (BACKHOE.base.height + BACKHOE.swing.height)
    before = np.zeros(len(postures))
    out = np.stack([-np.sin(postures[:, 0]), np.cos(postures[:, 0])], axis=-1)
    for name, link, q in zip(
        ("boom", "stick", "bucket"), BACKHOE.links, postures[:, 1:].T, strict=True
    ):
        centre = place + link.com_radius * np.exp(1j * (before + q + link.com_angle))
        found = kinematics.forward_kinematics(postures, f"{name}_com")[:, :3, 3]
        np.testing.assert_allclose(found[:, 2], centre.imag, atol=1e-12)
        reach = found[:, :2] - [BACKHOE.base.offset, 0.0]
        np.testing.assert_allclose(reach, centre.real[:, None] * out, atol=1e-12)
        before = before + q + link.angle_offset
        place = place + link.length * np.exp(1j * before)


@pytest.mark.parametrize("frame", kinematics.FRAMES)
def test_every_pose_is_a_rigid_transform(postures, frame):
    T = kinematics.forward_kinematics(postures, frame)
    R = T[:, :3, :3]
    np.testing.assert_allclose(
        R @ np.swapaxes(R, -1, -2), np.broadcast_to(np.eye(3), R.shape), atol=1e-14
    )
    np.testing.assert_allclose(np.linalg.det(R), 1, atol=1e-14)
    np.testing.assert_array_equal(T[:, 3], np.broadcast_to([0, 0, 0, 1], (300, 4)))


def test_arm_at_zero_points_left_with_the_stick_hanging_and_the_teeth_towards_the_machine():
    origins = kinematics.link_transforms(np.zeros(4))[:, :3, 3]
    np.testing.assert_allclose(origins[:, 0], BACKHOE.base.offset, atol=1e-15)
    swing, boom, stick, tip = origins
    assert boom[1] > swing[1] > 0
    assert stick[2] < boom[2] - 1.8
    assert tip[1] < stick[1] - 1.4


def test_swing_of_minus_90_degrees_points_the_arm_forward():
    tip = kinematics.forward_kinematics([FORWARD, 0, 0, 0])[:3, 3]
    assert tip[0] > 3
    assert tip[1] == pytest.approx(0, abs=1e-12)


def test_positive_joint_angles_raise_boom_and_stick_and_open_the_bucket():
    rest = kinematics.forward_kinematics([FORWARD, 0, 0, 0], "tip")
    for joint, frame in ((1, "boom"), (2, "stick")):
        q = np.array([FORWARD, 0, 0, 0])
        q[joint] = 0.1
        moved = kinematics.forward_kinematics(q, frame)[2, 3]
        assert moved > kinematics.forward_kinematics([FORWARD, 0, 0, 0], frame)[2, 3]
    opened = kinematics.forward_kinematics([FORWARD, 0, 0, 0.5])
    assert opened[0, 3] > rest[0, 3]


def test_a_length_changes_by_as_much_as_the_variant_says(postures):
    frames = kinematics.link_transforms(postures, LONG_STICK)
    gaps = np.linalg.norm(np.diff(frames[:, :, :3, 3], axis=1), axis=-1)
    np.testing.assert_allclose(gaps, np.broadcast_to([5.1243, 2.5, 1.484], gaps.shape))


def test_frames_and_jacobians_agree_with_pinocchio(postures):
    pin = pytest.importorskip("pinocchio")
    model = oracles.pinocchio_model()
    data = model.createData()
    for frame in ("boom", "stick", "tip"):
        index = model.getFrameId(frame)
        for q in postures[:50]:
            pin.computeJointJacobians(model, data, q)
            pin.updateFramePlacements(model, data)
            np.testing.assert_allclose(
                kinematics.forward_kinematics(q, frame), data.oMf[index].homogeneous, atol=1e-13
            )
            J = pin.getFrameJacobian(model, data, index, pin.LOCAL_WORLD_ALIGNED)
            np.testing.assert_allclose(kinematics.jacobian(q, frame), J, atol=1e-13)


@pytest.mark.parametrize("frame", kinematics.FRAMES)
@pytest.mark.parametrize("machine", [BACKHOE, LONG_STICK], ids=["backhoe", "long stick"])
def test_jacobian_is_the_derivative_of_the_pose(postures, frame, machine):
    J = kinematics.jacobian(postures, frame, machine)
    h = 1e-6
    for joint in range(4):
        dq = np.zeros(4)
        dq[joint] = h / 2
        before = kinematics.forward_kinematics(postures - dq, frame, machine)
        after = kinematics.forward_kinematics(postures + dq, frame, machine)
        linear = (after - before)[:, :3, 3] / h
        np.testing.assert_allclose(J[:, :3, joint], linear, atol=2e-9)
        np.testing.assert_allclose(J[:, 3:, joint], turn_rate(before, after, h), atol=1e-6)


def test_task_jacobian_is_the_derivative_of_the_task_pose(postures):
    J = kinematics.task_jacobian(postures)
    h = 1e-6
    for joint in range(4):
        dq = np.zeros(4)
        dq[joint] = h / 2
        rate = (kinematics.pose(postures + dq) - kinematics.pose(postures - dq)) / h
        np.testing.assert_allclose(J[:, :, joint], rate, atol=2e-9)


def test_pose_is_the_stick_tip_and_the_bucket_angle(postures):
    T = kinematics.forward_kinematics(postures, "stick")
    np.testing.assert_allclose(kinematics.pose(postures)[:, :3], T[:, :3, 3], atol=1e-15)
    np.testing.assert_array_equal(kinematics.pose(postures)[:, 3], postures[:, 3])


@pytest.mark.parametrize(
    "function",
    [
        kinematics.link_transforms,
        kinematics.forward_kinematics,
        lambda q: kinematics.forward_kinematics(q, "stick_com"),
        lambda q: kinematics.jacobian(q, "swing_com"),
        kinematics.jacobian,
        kinematics.task_jacobian,
        kinematics.pose,
        lambda q: kinematics.inverse_kinematics(kinematics.pose(q)),
    ],
)
def test_many_postures_give_what_each_gives_alone(postures, function):
    grid = postures[:24].reshape(2, 3, 4, 4)
    together = function(grid)
    alone = np.array([function(q) for q in grid.reshape(-1, 4)]).reshape(together.shape)
    np.testing.assert_allclose(together, alone, atol=1e-14)


# Inverse kinematics in closed form


@pytest.mark.parametrize("machine", [BACKHOE, LONG_STICK], ids=["backhoe", "long stick"])
def test_inverse_kinematics_undoes_forward_kinematics_with_the_elbow_up(postures, machine):
    q = kinematics.inverse_kinematics(kinematics.pose(postures, machine), machine=machine)
    np.testing.assert_allclose(q, postures, atol=1e-12)


def test_inverse_kinematics_undoes_forward_kinematics_with_the_elbow_down(rng, postures):
    q = postures.copy()
    q[:, 2] = rng.uniform(0.05, 1.5, len(q)) - BACKHOE.stick.angle_offset
    back = kinematics.inverse_kinematics(kinematics.pose(q), elbow="down")
    np.testing.assert_allclose(back, q, atol=1e-12)


def test_limits_hold_by_default_for_the_elbows_that_a_machine_can_bend(postures):
    target = kinematics.pose(postures[0])
    with pytest.raises(ValueError, match="stick"):
        kinematics.inverse_kinematics(target, elbow="down", limits=True)
    joint = replace(BACKHOE.stick.joint, upper=np.radians(100))
    supple = replace(BACKHOE, stick=replace(BACKHOE.stick, joint=joint))
    high = [4.0, 2.0, 5.0, 0.5]
    kinematics.inverse_kinematics(high, elbow="down")
    with pytest.raises(ValueError, match="its limit"):
        kinematics.inverse_kinematics(high, elbow="down", machine=supple)


@pytest.mark.parametrize("elbow", ["up", "down"])
def test_both_elbows_reach_the_target(postures, elbow):
    target = kinematics.pose(postures)
    q = kinematics.inverse_kinematics(target, elbow, limits=False)
    np.testing.assert_allclose(kinematics.pose(q), target, atol=1e-13)


def test_elbow_up_has_the_stick_joint_above_that_of_elbow_down(postures):
    target = kinematics.pose(postures)
    heights = [
        kinematics.forward_kinematics(
            kinematics.inverse_kinematics(target, elbow, limits=False), "boom"
        )[:, 2, 3]
        for elbow in ("up", "down")
    ]
    assert (heights[0] > heights[1]).all()


def test_swing_lies_in_the_half_open_turn(rng):
    angle = np.r_[rng.uniform(-np.pi, np.pi, 1000), 0, np.pi / 2, np.pi, -np.pi / 2]
    x, y = BACKHOE.base.offset + 5 * np.cos(angle), 5 * np.sin(angle)
    target = np.column_stack([x, y, np.full_like(x, 2.0), np.zeros_like(x)])
    swing = kinematics.inverse_kinematics(target)[:, 0]
    assert (swing > -np.pi).all()
    assert (swing <= np.pi).all()
    right = kinematics.inverse_kinematics([BACKHOE.base.offset, -5, 2, 0])
    assert right[0] == np.pi


def test_stretched_arm_is_still_within_reach():
    for swing in np.linspace(-3, 3, 50):
        q = [swing, 0.2, -BACKHOE.stick.angle_offset, 0]
        back = kinematics.inverse_kinematics(kinematics.pose(q), limits=False)
        np.testing.assert_allclose(back, q, atol=1e-5)


def test_pose_at_the_joint_limits_is_accepted():
    for q in (BACKHOE.lower, BACKHOE.upper):
        back = kinematics.inverse_kinematics(kinematics.pose(q))
        np.testing.assert_allclose(np.cos(back), np.cos(q), atol=1e-12)
        np.testing.assert_allclose(back[1:], q[1:], atol=1e-9)


def reach_gap(target, machine=BACKHOE):
    """How far a target is beyond the stretched arm, found by searching the stretched poses."""
    stretched = np.zeros((200_001, 4))
    stretched[:, 0] = FORWARD
    stretched[:, 1] = np.linspace(-np.pi, np.pi, 200_001)
    stretched[:, 2] = -machine.stick.angle_offset
    reached = kinematics.pose(stretched, machine)[:, :3]
    return np.linalg.norm(reached - target[:3], axis=1).min()


def test_out_of_reach_message_gives_the_target_and_the_distance():
    target = [9.0, 0.0, 2.0, 0.0]
    message = (
        rf"target \(9.0, 0.0, 2.0\) m is {reach_gap(target):.3g} m outside the reach of the st"
    )
    with pytest.raises(ValueError, match=message):
        kinematics.inverse_kinematics(target)


def test_a_longer_stick_reaches_further():
    target = [8.5, 0.0, 2.0, 0.0]
    with pytest.raises(ValueError, match="outside the reach"):
        kinematics.inverse_kinematics(target, limits=False)
    q = kinematics.inverse_kinematics(target, machine=LONG_STICK, limits=False)
    np.testing.assert_allclose(kinematics.pose(q, LONG_STICK), target, atol=1e-13)


def test_too_close_message_gives_the_missing_distance():
    near = [BACKHOE.base.offset + BACKHOE.swing.offset + 1.0, 0, 1.1811 + 0.2756, 0]
    missing = BACKHOE.boom.length - BACKHOE.stick.length - 1.0
    with pytest.raises(ValueError, match=f"is {missing:.3g} m too close to the boom's joint"):
        kinematics.inverse_kinematics(near)


def test_target_on_the_swing_axis_is_refused_by_name():
    with pytest.raises(ValueError, match="on the swing axis, where every swing angle fits"):
        kinematics.inverse_kinematics([BACKHOE.base.offset, 0.0, 5.0, 0.0])


@pytest.mark.parametrize(
    ("q_deg", "message"),
    [
        ([-90, 70, 0, 0], "the boom at 70.0 deg, above its limit of 60.0 deg"),
        ([-90, -55, 0, 0], "the boom at -55.0 deg, below its limit of -50.0 deg"),
        ([-90, 0, 65, 0], "the stick at 65.0 deg, above its limit of 60.0 deg"),
        ([-90, 0, 0, -41], "the bucket at -41.0 deg, below its limit of -40.0 deg"),
    ],
)
def test_limit_message_names_joint_angle_and_limit_in_degrees(q_deg, message):
    target = kinematics.pose(np.radians(q_deg))
    with pytest.raises(ValueError, match=message):
        kinematics.inverse_kinematics(target)
    q = kinematics.inverse_kinematics(target, limits=False)
    np.testing.assert_allclose(np.degrees(q), q_deg, atol=1e-9)


def test_a_tighter_joint_makes_a_variant_refuse():
    tight = replace(
        BACKHOE, boom=replace(BACKHOE.boom, joint=replace(BACKHOE.boom.joint, upper=0.1))
    )
    target = kinematics.pose([FORWARD, 0.3, 0, 0])
    kinematics.inverse_kinematics(target)
    with pytest.raises(ValueError, match=r"the boom at 17.2 deg, above its limit of 5.7 deg"):
        kinematics.inverse_kinematics(target, machine=tight)


def test_batch_error_names_the_first_bad_target_and_how_many():
    target = np.tile(kinematics.pose([FORWARD, 0, 0, 0]), (2, 3, 1))
    target[1, 0, 0] = target[1, 2, 0] = 20.0
    with pytest.raises(ValueError, match="the first of 2 without a solution, at index 1, 0"):
        kinematics.inverse_kinematics(target)


def test_targets_without_a_solution_become_nan_on_request_and_the_others_stay(rng):
    target = rng.uniform([-8, -8, -5, 0], [8, 8, 9, 1], (20_000, 4))
    q = kinematics.inverse_kinematics(target, on_failure="nan")
    bad = np.isnan(q).any(axis=1)
    assert 0.3 < bad.mean() < 0.95
    assert np.isnan(q[bad]).all()
    np.testing.assert_allclose(kinematics.pose(q[~bad]), target[~bad], atol=1e-12)
    assert (q[~bad] >= BACKHOE.lower - 1e-9).all()
    assert (q[~bad] <= BACKHOE.upper + 1e-9).all()
    for one in target[bad][:50]:
        with pytest.raises(ValueError, match="target"):
            kinematics.inverse_kinematics(one)


# Damped least squares


@pytest.mark.parametrize("damping", [0.01, 0.1, 1.0])
@pytest.mark.parametrize("shape", [(4, 4), (3, 4), (6, 4)])
def test_damped_inverse_solves_the_damped_normal_equations(rng, damping, shape):
    J = rng.normal(size=(20, *shape))
    J_T = np.swapaxes(J, -1, -2)
    expected = np.linalg.solve(J_T @ J + damping**2 * np.eye(shape[1]), J_T)
    np.testing.assert_allclose(
        kinematics.damped_inverse(J, damping), expected, atol=1e-12 / damping**2
    )


def test_damped_inverse_without_damping_is_the_pseudo_inverse(rng):
    J = rng.normal(size=(5, 3, 4))
    np.testing.assert_allclose(kinematics.damped_inverse(J, 0.0), np.linalg.pinv(J), atol=1e-12)
    np.testing.assert_array_equal(kinematics.damped_inverse(np.zeros((3, 4)), 0.0), 0)


def test_gain_of_the_damped_inverse_never_exceeds_half_the_reciprocal_damping():
    stretched = -BACKHOE.stick.angle_offset
    bends = np.r_[0, np.logspace(-8, -1, 2000)]
    q = np.column_stack([0 * bends, 0 * bends, stretched - bends, 0 * bends])
    J = kinematics.jacobian(q, "stick")[:, :3, :3]
    gain = np.linalg.norm(kinematics.damped_inverse(J, 0.1), ord=2, axis=(-2, -1))
    assert gain.max() == pytest.approx(5.0, rel=1e-3)
    assert gain.max() <= 5.0 + 1e-12
    undamped = np.linalg.norm(np.linalg.inv(J[1:]), ord=2, axis=(-2, -1))
    assert undamped.max() > 1e6


def test_adaptive_damping_is_zero_in_the_open_and_largest_at_the_singularity():
    bent = kinematics.task_jacobian([0, 0.2, -0.3, 0])
    stretched = kinematics.task_jacobian([0, 0.2, -BACKHOE.stick.angle_offset, 0])
    assert kinematics.adaptive_damping(bent) == 0
    assert kinematics.adaptive_damping(stretched, largest=0.1) == pytest.approx(0.1)
    q = np.zeros((50, 4))
    q[:, 2] = -BACKHOE.stick.angle_offset - np.linspace(0, 0.5, 50)
    damping = kinematics.adaptive_damping(kinematics.task_jacobian(q))
    assert (np.diff(damping) <= 0).all()


def test_adaptive_damping_falls_on_a_quarter_of_a_circle():
    sigma = np.linspace(0.0, 0.2, 5)
    J = np.eye(3) * np.ones((5, 1, 1))
    J[:, 1, 1] = sigma
    damping = kinematics.adaptive_damping(J, largest=0.1, threshold=0.2)
    np.testing.assert_allclose((damping / 0.1) ** 2 + (sigma / 0.2) ** 2, 1.0)


@pytest.mark.parametrize("damping", [None, 0.0, 0.05])
def test_damped_iteration_arrives_at_the_closed_form(rng, postures, damping):
    target = kinematics.pose(postures)
    start = postures + rng.uniform(-0.2, 0.2, postures.shape)
    result = kinematics.solve_damped(target, start, damping=damping)
    assert result.converged.all()
    assert np.abs(result.residual).max() <= 1e-9
    np.testing.assert_allclose(result.q, kinematics.inverse_kinematics(target), atol=1e-7)


def test_damped_iteration_reports_its_path():
    q = np.array([FORWARD, 0.3, -0.4, 0.5])
    start = np.array([FORWARD + 0.5, 0.0, 0.0, 0.0])
    result = kinematics.solve_damped(kinematics.pose(q), start)
    assert bool(result.converged)
    assert result.path.shape == (result.iterations + 1, 4)
    np.testing.assert_array_equal(result.path[0], start)
    np.testing.assert_array_equal(result.path[-1], result.q)
    assert np.abs(np.diff(result.path, axis=0)).max() <= 0.3 + 1e-12


def test_damped_iteration_started_at_the_answer_makes_no_step():
    q = np.array([FORWARD, 0.3, -0.4, 0.5])
    result = kinematics.solve_damped(kinematics.pose(q), q)
    assert result.iterations == 0
    assert bool(result.converged)


def test_damped_iteration_starts_from_the_stretched_arm():
    start = [FORWARD, 0.2, -BACKHOE.stick.angle_offset, 0]
    target = kinematics.pose([FORWARD, 0.4, 0.2, 0.3])
    result = kinematics.solve_damped(target, start)
    assert np.isfinite(result.path).all()
    assert bool(result.converged)


@pytest.mark.parametrize("damping", [None, 0.1])
def test_out_of_reach_target_leaves_the_damped_arm_stretched_towards_it(damping):
    target = np.array([9.0, 0.0, 2.0, 0.0])
    start = [FORWARD, 0.3, -0.3, 0.0]
    result = kinematics.solve_damped(target, start, damping=damping, max_iterations=1000)
    assert not result.converged
    gap = np.linalg.norm(result.residual)
    assert gap == pytest.approx(reach_gap(target), rel=1e-4)
    assert result.iterations < 1000
    distance = np.linalg.norm(target - kinematics.pose(result.path), axis=1)
    assert (np.diff(distance) <= 0).all()


# Bad input


@pytest.mark.parametrize(
    "function",
    [
        kinematics.link_transforms,
        kinematics.forward_kinematics,
        kinematics.jacobian,
        kinematics.pose,
        kinematics.task_jacobian,
    ],
)
@pytest.mark.parametrize(
    ("q", "message"),
    [
        (
            np.zeros((2, 3)),
            r"must end in 4 joints \(swing, boom, stick, bucket\), got shape \(2, 3\)",
        ),
        (1.0, r"must end in 4 joints .* got shape \(\)"),
        ([0, 0, np.nan, 0], "q must be finite, got nan at index 2"),
        ([[0, 0, 0, 0], [0, 0, 0, np.inf]], r"q must be finite, got inf at index \(1, 3\)"),
        ("abcd", "q must be numbers, got"),
        ([0, 0, None, "x"], "q must be numbers, got"),
        ([[0, 0, 0, 0], [0, 0]], "q must be numbers, got"),
        (np.array([1j, 0, 0, 0]), "q must be numbers, got"),
        (["0", "0", "0", "0"], "q must be numbers, got"),
        (np.array(["1", 0, 0, 0], dtype=object), "q must be numbers, got"),
        (np.arange(4).astype("timedelta64[s]"), "q must be numbers, got"),
        ([10**400, 0, 0, 0], "q must be numbers, got"),
    ],
)
def test_bad_joint_angles_are_refused(function, q, message):
    with pytest.raises(ValueError, match=message):
        function(q)


@pytest.mark.parametrize("function", [kinematics.forward_kinematics, kinematics.jacobian])
@pytest.mark.parametrize("frame", ["bucket", "", None, 3])
def test_unknown_frame_is_refused_with_the_list_of_frames(function, frame):
    with pytest.raises(ValueError, match="frame must be one of swing, boom, stick, tip"):
        function(np.zeros(4), frame)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([1, 2, 3],), r"target must end in 4 values \(x, y, z, angle\), got shape \(3,\)"),
        ((5.0,), r"got shape \(\)"),
        (([5, 0, np.nan, 0],), "target must be finite, got nan at index 2"),
        (("here",), "target must be numbers"),
        ((np.array([5, 0, 2, 1j]),), "target must be numbers"),
        ((["5", "0", "2", "0"],), "target must be numbers"),
        (([5, 0, 2, 0], ["up"]), "elbow must be one of up, down"),
        (([5, 0, 2, 0], "left"), "elbow must be one of up, down, got 'left'"),
        (([5, 0, 2, 0], "up", BACKHOE, True, "ignore"), "on_failure must be one of raise, nan"),
    ],
)
def test_bad_targets_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        kinematics.inverse_kinematics(*arguments)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: kinematics.damped_inverse(np.eye(3), -0.1), "damping must not be negative"),
        (
            lambda: kinematics.damped_inverse(np.ones(3), 0.1),
            r"J must be matrices, .* shape \(3,\)",
        ),
        (lambda: kinematics.damped_inverse(np.eye(3) * np.nan, 0.1), "J must be finite"),
        (lambda: kinematics.damped_inverse(np.eye(3) * 1j, 0.1), "J must be numbers"),
        (lambda: kinematics.damped_inverse(np.eye(3), "some"), "damping must be numbers"),
        (
            lambda: kinematics.adaptive_damping(np.eye(3), -1.0),
            "largest must be one number at least 0",
        ),
        (lambda: kinematics.adaptive_damping(np.ones(3)), r"J must be matrices, .* shape \(3,\)"),
        (lambda: kinematics.adaptive_damping(np.eye(3) * np.nan), "J must be finite"),
        (
            lambda: kinematics.solve_damped(np.ones((2, 4)), np.zeros((3, 4))),
            r"the leading axes must fit each other, got shapes \(2, 4\), \(3, 4\)",
        ),
        (lambda: kinematics.solve_damped([5, 0, 2], np.zeros(4)), "target must end in 4"),
        (lambda: kinematics.solve_damped([5, 0, 2, 0], np.zeros(3)), "q0 must end in 4 joints"),
        (
            lambda: kinematics.solve_damped([5, 0, 2, 0], np.zeros(4), tolerance=0),
            "tolerance must be one number above 0, got 0",
        ),
        (
            lambda: kinematics.solve_damped([5, 0, 2, 0], np.zeros(4), damping=-0.1),
            "damping must be one number at least 0, got -0.1",
        ),
        (
            lambda: kinematics.solve_damped([5, 0, 2, 0], np.zeros(4), max_iterations=2.5),
            "max_iterations must be one whole number at least 1, got 2.5",
        ),
        (lambda: kinematics.dh_transform("q1", 0, 0, 0), "theta must be numbers, got 'q1'"),
    ],
)
def test_other_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_import_brings_numpy_and_nothing_heavy():
    code = (
        "import sys, backhoe.arm.kinematics, backhoe.arm.dynamics, backhoe.arm.integrate;"
        "print(*{name.split('.')[0] for name in sys.modules})"
    )
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert "numpy" in loaded
    assert not {"scipy", "numba", "matplotlib", "pybullet", "IPython"} & set(loaded)
