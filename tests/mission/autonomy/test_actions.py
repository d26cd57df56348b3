"""The queue of movements: order, feedback, results, cancelling; and the three of the thesis."""

import numpy as np
import pytest

from backhoe import simulation
from backhoe.arm import dynamics, pid
from backhoe.arm.kinematics import inverse_kinematics, pose
from backhoe.machine import BACKHOE
from backhoe.mission.autonomy import ActionServer, Goal, along, reach

REST = np.radians([-90.0, 30.0, -30.0, 0.0])
THESIS = (
    ("start", (5.45, -0.40, 1.84, 0.00), 6.0),
    ("dig", (6.00, -0.50, 2.00, -0.30), 14.0),
    ("load", (1.77, 4.20, 3.35, 1.35), 16.0),
)
"""Section 6.7.3: name, goal of the stick's tip [m] and the bucket [rad], time [s]."""


def followed(server, steps, until=lambda: False):
    """References of a machine that follows perfectly."""
    q, log = server.q_ref, []
    for _ in range(steps):
        if until():
            break
        q, dq = server.step(q)
        log.append((q.copy(), dq.copy()))
    return log


def test_the_movements_of_the_thesis_reach_their_goals_in_their_times():
    server = ActionServer(REST, 0.01)
    actions = [server.send(reach(name, goal, time)) for name, goal, time in THESIS]
    assert [action.status for action in actions] == ["queued"] * 3
    ends = []
    for action, (_, goal, time) in zip(actions, THESIS, strict=True):
        log = followed(server, 2000, lambda a=action: a.done)
        ends.append(len(log))
        np.testing.assert_allclose(pose(log[-1][0]), goal, atol=1e-6)
        assert len(log) == pytest.approx(time / 0.01, abs=1)
    assert [action.status for action in actions] == ["succeeded"] * 3


def test_chapter_three_s_controller_carries_them_out_on_torque():
    server = ActionServer(REST, 0.001)
    name, goal, time = THESIS[0]
    action, control = server.send(reach(name, goal, time)), pid.PID(*pid.ARM_GAINS)
    with simulation.open_world(
        backend="analytic", scene=simulation.scene.FLAT, soil=False
    ) as world:
        while not action.done:
            q, dq = world.q, world.dq
            torque = control(*server.step(q), q, dq, world.dt)
            world.step(torque + dynamics.gravity_torque(q))
        np.testing.assert_allclose(pose(world.q), goal, atol=0.1)
    assert action.status == "succeeded" and world.time < time + 1.0


def test_feedback_comes_ten_times_a_second_and_ends_at_one():
    server = ActionServer(REST, 0.01)
    action = server.send(reach("start", THESIS[0][1], 2.0))
    followed(server, 1000, lambda: action.done)
    times = [report.time for report in action.feedback]
    np.testing.assert_allclose(np.diff(times), 0.1, atol=1e-9)
    np.testing.assert_allclose([r.done for r in action.feedback], np.array(times) / 2.0)
    server = ActionServer(REST, 0.01)
    action = server.send(reach("start", THESIS[0][1], 2.0))
    for _ in range(100):
        server.step(REST)
    assert action.feedback[-1].off == pytest.approx(np.abs(server.q_ref - REST).max())


def test_a_cancelled_movement_says_so_and_comes_to_rest_without_a_jump():
    server = ActionServer(REST, 0.01)
    first, second = (server.send(reach(n, g, 4.0)) for n, g, _ in THESIS[:2])
    log = followed(server, 200)
    speed = log[-1][1]
    server.cancel(first, "the truck has left")
    log += followed(server, 60, lambda: first.done)
    assert first.status == "cancelled" and first.result == "the truck has left"
    q, dq = (np.array(column) for column in zip(*log, strict=True))
    np.testing.assert_allclose(dq[-1], 0.0, atol=1e-12)
    np.testing.assert_allclose(q[-1] - q[199], speed * 0.5 / 2, atol=0.02 * np.abs(speed).max())
    assert np.abs(np.diff(dq, axis=0)).max() < 0.03
    followed(server, 600, lambda: second.done)
    assert second.status == "succeeded"
    np.testing.assert_allclose(pose(server.q_ref), THESIS[1][1], atol=1e-6)


def test_one_that_waits_never_begins_once_it_is_cancelled():
    server = ActionServer(REST, 0.01)
    first, second = (server.send(reach(n, g, 1.0)) for n, g, _ in THESIS[:2])
    server.cancel(second)
    assert second.status == "cancelled" and not second.feedback
    followed(server, 500, lambda: first.done)
    assert server.active is None
    with pytest.raises(ValueError, match=r"'dig' is cancelled"):
        server.cancel(second)
    with pytest.raises(ValueError, match="not in this queue"):
        server.cancel(ActionServer(REST, 0.01).send(reach("x", THESIS[0][1], 1.0)))


def test_what_cannot_be_done_fails_in_words_and_ends_the_queue():
    server = ActionServer(REST, 0.01)
    far = server.send(reach("far", (12.0, 0.0, 1.0, 0.0), 3.0))
    after = server.send(reach("after", THESIS[0][1], 3.0))
    q, dq = server.step(REST)
    np.testing.assert_array_equal(q, REST)
    np.testing.assert_array_equal(dq, 0.0)
    assert far.status == "failed" and "cannot be done" in far.result
    assert after.status == "cancelled" and "'far'" in after.result


def test_a_joint_that_does_not_follow_makes_the_movement_fail():
    server = ActionServer(REST, 0.01)
    action = server.send(reach("start", THESIS[0][1], 1.0))
    for _ in range(400):
        server.step(REST)
    wanted = np.abs(inverse_kinematics(THESIS[0][1]) - REST).max()
    assert action.status == "failed" and f"{wanted:.2f} rad" in action.result


def test_a_movement_too_fast_for_a_joint_is_slowed_down():
    server = ActionServer(REST, 0.01)
    action = server.send(reach("swing", (0.4, 5.7, 3.9, 0.0), 0.5))
    log = followed(server, 1000, lambda: action.done)
    assert (np.abs([dq for _, dq in log]) <= BACKHOE.speed_limit + 1e-9).all()
    assert action.status == "succeeded"


def test_a_path_is_passed_at_its_times_after_the_way_to_its_beginning():
    server = ActionServer(REST, 0.01)
    path = np.array([goal for _, goal, _ in THESIS[:2]])
    action = server.send(along("dig", [3.0, 7.0], path, begin=2.0))
    log = followed(server, 1000, lambda: action.done)
    np.testing.assert_allclose(pose(log[199][0]), path[0], atol=1e-6)
    assert len(log) == 600


def test_bad_goals_are_named():
    with pytest.raises(TypeError, match="goal"):
        ActionServer(REST, 0.01).send("dig")
    with pytest.raises(TypeError, match="motion"):
        Goal("dig", 3)
    with pytest.raises(ValueError, match="duration"):
        reach("dig", THESIS[0][1], 0.0)
    with pytest.raises(ValueError, match="target"):
        reach("dig", (1.0, 2.0), 1.0)
    with pytest.raises(ValueError, match="must rise"):
        along("dig", [0.0, 0.0], np.zeros((2, 4)))
    with pytest.raises(ValueError, match="q must be"):
        ActionServer(REST[:3], 0.01)
