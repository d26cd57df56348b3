"""Robots that move, paths for their hands, and what a known lag of the drives is good for."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from backhoe.vehicle.tracking.ideal_plant import arc
from backhoe.whole_body import (
    BACKHOE,
    SLIDES,
    HandPath,
    KinematicPlant,
    circle_path,
    eight_path,
    follow,
    hand,
    jacobian,
    minimum_norm,
    sine_path,
)

START = {
    SLIDES: np.array([0.3, -0.2, 0.4, 0.2, 0.9, -1.2]),
    BACKHOE: np.array([0.3, -0.2, 0.4, -1.6, 0.5, -0.6, -0.3]),
}
NORTH, AHEAD = np.array([0, 3.0, 0]), np.array([0.1, 0, 0])
ROBOTS = pytest.mark.parametrize("robot", [SLIDES, BACKHOE], ids=["slides", "backhoe"])
PATHS = {
    "sine": lambda at, size: sine_path(at, 20, length=4 * size, sideways=size / 3, upwards=0.05),
    "circle": lambda at, size: circle_path(at, 15, radius=size / 2, tilt=0.4, heading=0.3),
    "eight": lambda at, size: eight_path(at, 20, length=size, width=size / 2, height=size / 4),
}


def a_path(kind, robot, q=None):
    return PATHS[kind](hand(START[robot] if q is None else q, robot), 0.8 if robot is SLIDES else 2)


def rms(run):
    return float(np.sqrt((run.error**2).mean()))


# The plant


@ROBOTS
def test_without_lag_the_platform_drives_an_arc_and_the_joints_turn_evenly(robot):
    v = np.linspace(0.9, -0.7, 2 + robot.joints)
    plant = KinematicPlant(robot, START[robot], dt=0.7)
    plant.step(v)
    assert_allclose(plant.q[:3], arc(START[robot][:3], v[0], v[1], 0.7), atol=1e-12)
    assert_allclose(plant.q[3:], START[robot][3:] + 0.7 * v[2:], atol=1e-14)
    assert plant.time == 0.7


@pytest.mark.parametrize("lag", [0.3, 0.02, [0.0, 0.3, 0.1, 0.0, 0.5], [0.4, 0.0, 0.1, 0.0, 0.5]])
def test_a_lag_is_that_of_the_differential_equation(lag):
    v, dt, n = np.array([0.8, -2.0, 0.3, -0.4, 0.5]), 0.4, 6
    plant = KinematicPlant(SLIDES, START[SLIDES], dt=dt, lag=lag)
    times = np.broadcast_to(lag, (5,)).astype(float)

    def rate(_, x, wanted):
        own = np.where(times > 0, x[n:], wanted)
        slopes = np.where(times > 0, (wanted - x[n:]) / np.where(times > 0, times, 1), 0)
        return [own[0] * np.cos(x[2]), own[0] * np.sin(x[2]), *own[1:], *slopes]

    x = np.r_[START[SLIDES], np.zeros(5)]
    for wanted in (v, -v, 0.5 * v):
        plant.step(wanted)
        x = solve_ivp(rate, (0, dt), x, args=(wanted,), rtol=1e-11, atol=1e-12).y[:, -1]
        assert_allclose(plant.q, x[:n], atol=2e-9)
        assert_allclose(plant.v[times > 0], x[n:][times > 0], atol=1e-9)
        assert_allclose(plant.v[times == 0], wanted[times == 0], atol=1e-12)


def test_a_drive_gives_no_more_than_it_can():
    plant = KinematicPlant(SLIDES, dt=0.1, fastest=[0.5, 1, 1, 1, 1])
    plant.step([3.0, -2.0, 0.5, 0, 0])
    assert_allclose(plant.v, [0.5, -1, 0.5, 0, 0])
    plant.reset()
    assert not plant.q.any() and not plant.v.any() and plant.time == 0


def test_bad_plants():
    for options in ({"lag": -0.1}, {"lag": [0.1, 0.2]}, {"fastest": np.zeros(5)}, {"dt": 0.0}):
        with pytest.raises(ValueError, match=next(iter(options))):
            KinematicPlant(SLIDES, **options)
    with pytest.raises(ValueError, match="3 joints"):
        KinematicPlant(SLIDES, np.zeros(7))
    with pytest.raises(ValueError, match="u, omega"):
        KinematicPlant(SLIDES).step(np.zeros(6))


# Paths


@pytest.mark.parametrize("kind", PATHS)
def test_a_path_has_the_velocity_it_says_and_no_jump_in_it(kind):
    path = a_path(kind, SLIDES)
    t = np.linspace(-0.5, path.duration + 0.5, 4001)
    difference = (path(t + 1e-6) - path(t - 1e-6)) / 2e-6
    assert_allclose(path.velocity(t), difference, atol=1e-8)
    assert np.linalg.norm(np.diff(path.velocity(t), axis=0), axis=1).max() < 0.01
    assert not path.velocity([0.0, path.duration]).any()


def test_closed_paths_close_and_the_sine_arrives():
    at = np.array([1.0, 2.0, 0.5])
    for closed in (circle_path(at, turns=2), eight_path(at)):
        assert_allclose(closed([0.0, closed.duration]), [at, at], atol=1e-12)
    path = sine_path(at, length=3, waves=2, sideways=0.3, heading=np.pi / 2)
    assert_allclose(path(path.duration), at + NORTH, atol=1e-12)
    way = path(np.linspace(0, path.duration, 20001)) - at
    assert_allclose([way[:, 0].min(), way[:, 0].max()], [-0.3, 0.3], atol=1e-5)


def test_the_circle_is_a_circle_and_the_eight_crosses_itself():
    at, t = np.array([1.0, 2.0, 0.5]), np.linspace(0, 20, 301)
    circle = circle_path(at, 20, radius=0.5, tilt=0.3, heading=0.7)
    middle = at + 0.5 * np.array(
        [*(np.cos(0.3) * np.array([np.cos(0.7), np.sin(0.7)])), np.sin(0.3)]
    )
    assert_allclose(np.linalg.norm(circle(t) - middle, axis=1), 0.5, atol=1e-12)
    assert (np.cross(circle.velocity(2.0), circle(2.0) - middle))[2] < 0  # to the right
    eight = eight_path(at, 20, length=1.0, width=0.5, height=0.3)
    assert_allclose(eight(10.0), at, atol=1e-12)
    size = np.ptp(eight(np.linspace(0, 20, 20001)), axis=0)
    assert_allclose(size, [1.0, 0.5, 0.3], atol=1e-5)


def test_bad_paths():
    with pytest.raises(ValueError, match="soft"):
        circle_path(np.zeros(3), 2.0, soft=1.5)
    with pytest.raises(ValueError, match="start"):
        eight_path(np.zeros(2))
    with pytest.raises(ValueError, match="sines"):
        HandPath(np.zeros(3), np.zeros(3), np.zeros((1, 3)), np.zeros((2, 3)), 5.0)


# Following


@ROBOTS
@pytest.mark.parametrize("kind", PATHS)
def test_what_a_continuous_plant_leaves_falls_with_the_square_of_the_step(robot, kind):
    q, left = START[robot], []
    for dt in (0.1, 0.05, 0.025):
        run = follow(KinematicPlant(robot, q, dt=dt), a_path(kind, robot), W=0.5)
        left.append(rms(run))
    assert_allclose(np.divide(left[:-1], left[1:]), 4, rtol=0.06)


def test_the_error_of_one_step_is_half_its_square_times_the_curvature_of_the_hand_s_way():
    """h(t + T) = h + T J v + T^2/2 dJ/dt v + ..., and W e of the error before."""
    robot, dt, W = SLIDES, 0.05, 0.3
    run = follow(KinematicPlant(robot, START[robot], dt=dt), a_path("eight", robot), W=W)
    e = run.goal - run.hand
    for k in range(20, 300, 40):
        v, q = run.told[k], run.q[k]
        rates = np.r_[v[0] * np.cos(q[2]), v[0] * np.sin(q[2]), v[1:]]
        bend = (jacobian(q + 1e-6 * rates, robot) - jacobian(q - 1e-6 * rates, robot)) @ v / 2e-6
        assert_allclose(e[k + 1] - W * e[k], -(dt**2) / 2 * bend, atol=3e-6)


def test_the_log_is_what_happened():
    plant = KinematicPlant(BACKHOE, START[BACKHOE], dt=0.1)
    run = follow(plant, a_path("circle", BACKHOE), duration=3.0)
    assert run.time[[0, -1]] == pytest.approx([0, 3.0])
    assert run.q.shape == (31, 7) and run.told.shape == (30, 6) and run.v.shape == (31, 6)
    assert_allclose(run.v[1:], run.told)
    assert_allclose(run.hand, hand(run.q))
    assert_allclose(run.error, np.linalg.norm(run.goal - run.hand, axis=1))
    J = jacobian(run.q[7])
    assert run.w[7] == pytest.approx(np.sqrt(np.linalg.det(J @ J.T)))
    arm = J[:, 2:]
    assert run.w_arm[7] == pytest.approx(np.sqrt(np.linalg.det(arm @ arm.T)))


def test_preferred_velocities_go_into_the_null_space_and_the_hand_stays_on_its_way():
    q = START[SLIDES]

    def fold(q):
        return np.r_[0, 0, 1.0 * (np.array([0.0, 1.3, -2.0]) - q[3:])]

    runs = [
        follow(KinematicPlant(SLIDES, q, dt=0.05), a_path("sine", SLIDES), W=0.5, preferred=p)
        for p in (None, fold)
    ]
    assert_allclose(runs[1].q[-1, 3:], [0, 1.3, -2.0], atol=0.15)
    assert np.abs(runs[0].q[-1, 3:] - [0, 1.3, -2.0]).max() > 0.5
    assert max(rms(run) for run in runs) < 5e-4


# Velocities that are not those told


def overshoot(W, lag, dt, known=0.0):
    """By how much the hand passes a goal 0.1 m ahead, as a share of that."""
    q = START[SLIDES] * [1, 1, 0, 0, 1, 1]
    still = circle_path(hand(q, SLIDES) + AHEAD, 4, radius=1e-9)
    run = follow(KinematicPlant(SLIDES, q, dt=dt, lag=lag), still, W=W, lag=known)
    return float((run.hand - run.goal)[:, 0].max() / 0.1)


@pytest.mark.parametrize(("dt", "lag"), [(0.01, 0.1), (0.02, 0.2), (0.01, 0.05)])
def test_with_a_lag_the_hand_overshoots_where_W_is_below_one_minus_T_over_four_lags(dt, lag):
    """lag e'' + e' + (1 - W) / T e = 0 is critically damped there."""
    limit = 1 - dt / (4 * lag)
    assert overshoot(limit + 0.3 * (1 - limit), lag, dt) < 2e-3
    assert overshoot(1 - 4 * (1 - limit), lag, dt) > 0.1
    a = np.exp(-dt / lag)
    b, e, v, passed = lag / dt * (1 - a), 1.0, 0.0, 0.0
    for _ in range(200):  # the same for one coordinate, held from sample to sample
        wanted = (1 - 0.6) * e / dt
        e, v = e - dt * ((1 - b) * wanted + b * v), a * v + (1 - a) * wanted
        passed = max(passed, -e)
    assert overshoot(0.6, lag, dt) == pytest.approx(passed, rel=0.1)


@pytest.mark.parametrize("W", [0.0, 0.5, 0.9])
def test_a_controller_that_knows_the_lag_does_not_overshoot(W):
    assert overshoot(W, 0.2, 0.02) > 0.1
    assert overshoot(W, 0.2, 0.02, known=0.2) < 0.01


@pytest.mark.parametrize("kind", PATHS)
def test_with_a_lag_the_error_grows_by_what_the_velocities_lack(kind):
    """And shrinks by the share of the step in which the drives do what they were told."""
    lag, dt, W = 0.1, 0.005, 0.975
    run, knowing = (
        follow(
            KinematicPlant(SLIDES, START[SLIDES], dt=dt, lag=lag),
            a_path(kind, SLIDES),
            W=W,
            lag=known,
            duration=5.0,
        )
        for known in (0.0, lag)
    )
    kept = lag / dt * (1 - np.exp(-dt / lag))  # of the old velocities, in the mean over a step
    moves = np.einsum("nij,nj->ni", jacobian(run.q, SLIDES), run.v)[:-1]
    lack = kept * (np.diff(run.goal, axis=0) - dt * moves)
    e = run.goal - run.hand
    grown = e[1:] - (1 - (1 - kept) * (1 - W)) * e[:-1]
    assert_allclose(grown, lack, atol=0.05 * np.abs(lack).max())
    assert rms(knowing) < 0.15 * rms(run)


def test_unlike_lags_are_known_one_by_one():
    lag = [0.25, 0.15, 0.05, 0.0, 0.1]
    runs = [
        follow(
            KinematicPlant(SLIDES, START[SLIDES], dt=0.02, lag=lag),
            a_path("eight", SLIDES),
            W=0.9,
            lag=known,
        )
        for known in (0.0, lag)
    ]
    assert rms(runs[1]) < 0.2 * rms(runs[0])


# Bad input


def test_a_path_that_jumps_is_refused_and_the_step_named():
    def jumps(t):
        return hand(START[SLIDES], SLIDES) + np.outer(t > 1.0, [0.4, 0, 0])

    plant = KinematicPlant(SLIDES, START[SLIDES], dt=0.1)
    with pytest.raises(
        ValueError, match=r"at most 0.3 m from goal, got 0.4 m in step 10: the path jumps"
    ):
        follow(plant, jumps, duration=2.0)
    assert plant.time == 0


def test_bad_calls():
    plant = KinematicPlant(SLIDES, START[SLIDES])
    path = a_path("sine", SLIDES)
    with pytest.raises(TypeError, match="path"):
        follow(plant, "sine")
    with pytest.raises(TypeError, match="preferred"):
        follow(plant, path, preferred=np.zeros(5))
    with pytest.raises(ValueError, match="W must"):
        follow(plant, path, W=1.0)
    with pytest.raises(ValueError, match="lag"):
        follow(plant, path, lag=[0.1, 0.1])
    with pytest.raises(ValueError, match=r"path\(times\)"):
        follow(plant, lambda t: np.zeros(3), duration=1.0)


def test_where_there_is_no_solution_the_error_says_when():
    def solve(J, b, v0):
        return minimum_norm(J if plant.time < 0.45 else np.ones((3, 5)), b, v0)

    plant = KinematicPlant(SLIDES, START[SLIDES])
    with pytest.raises(ValueError, match="rows of J") as caught:
        follow(plant, a_path("sine", SLIDES), solve=solve)
    assert "0.50 s" in caught.value.__notes__[0]


def test_any_solution_may_be_given():
    def least(J, b, v0):
        return np.linalg.lstsq(J, b, rcond=None)[0]

    ends = [
        follow(
            KinematicPlant(SLIDES, START[SLIDES]), a_path("sine", SLIDES), solve=solve, duration=5
        ).q[-1]
        for solve in (minimum_norm, least)
    ]
    assert_allclose(*ends, atol=1e-9)


def test_a_path_can_be_compared_and_kept():
    """Its arrays are not: two paths are alike only if they are one."""
    one, other = sine_path([0, 0, 0]), sine_path([0, 0, 0])
    assert one == one and one != other
    assert len({one, other, one}) == 2
