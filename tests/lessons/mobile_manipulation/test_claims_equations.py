"""What lesson 12a says in strong words, and in numbers."""

from functools import cache
from importlib.util import find_spec
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose

from backhoe import simulation
from backhoe.simulation.whole_body_plant import WholeBodyPlant
from backhoe.whole_body import (
    BACKHOE,
    SLIDES,
    KinematicPlant,
    SlidesRobot,
    circle_path,
    eight_path,
    follow,
    hand,
    jacobian,
    minimum_norm,
    null_projector,
    sine_path,
)

START = np.array([0.0, 0.0, 0.0, 0.3, 0.9, -1.4])
PLACE = hand(START, SLIDES)
PATHS = {
    "ring": circle_path(PLACE, 140, radius=0.25, tilt=0.3, heading=np.pi / 2, turns=7),
    "sine": sine_path(PLACE, 140, length=14, waves=12, sideways=0.3, upwards=0.05),
    "aside": lambda t: np.broadcast_to(np.add(PLACE, (0.0, 0.1, 0.0)), (*np.shape(t), 3)),
}


@pytest.fixture
def rng():
    return np.random.default_rng(12)


def back(q):
    return np.array([0.0, 0.0, *(START[3:] - q[3:])])


@cache
def run(path, T, W, seconds, preferred=None, lag=0.0, known=0.0):
    plant = KinematicPlant(SLIDES, START, dt=T, lag=lag)
    return follow(plant, PATHS[path], W=W, duration=seconds, preferred=preferred, lag=known)


def left(path, T, W, lag=0.0, known=0.0):
    """Root mean square of the error from 20 to 40 s [m]."""
    errors = run(path, T, W, 40.0, None, lag, known).error[round(20 / T) :]
    return np.sqrt((errors**2).mean())


def overshoot(W, lag, known):
    """How far beyond the goal the hand swings [m]."""
    log = run("aside", 0.1, W, 3.0, None, lag, known)
    return max(0.0, -(log.goal - log.hand)[:, 1].min())


def control_point(a, theta):
    """Columns of u and omega of a point a ahead of the axle, by the hand of a tiny arm there."""
    robot = SlidesRobot(a=a, h=1.0, l2=1e-9, l3=1e-9)
    return jacobian([1.0, -2.0, theta, 0.3, 0.2, 0.4], robot)[:2, :2]


def test_a_point_ahead_of_the_axle_moves_any_way_and_one_on_it_does_not(rng):
    for theta in rng.uniform(-3, 3, 10):
        c, s = np.cos(theta), np.sin(theta)
        assert_allclose(control_point(0.2, theta), [[c, -0.2 * s], [s, 0.2 * c]], atol=1e-8)
        assert np.linalg.matrix_rank(control_point(0.2, theta)) == 2
        assert np.linalg.matrix_rank(control_point(0.0, theta), tol=1e-6) == 1


def test_the_least_solution_depends_on_the_units():
    J, b = jacobian(START, SLIDES), np.array([0.1, 0.0, 0.0])
    in_centimetres = minimum_norm(J / [100, 1, 1, 1, 1], b) / [100, 1, 1, 1, 1]
    assert_allclose(in_centimetres, minimum_norm(J, b, weights=[1e4, 1, 1, 1, 1]), atol=1e-9)
    assert in_centimetres[0] < 0.01 * minimum_norm(J, b)[0]


def upright(bend):
    return jacobian([0.4, -1.0, 0.0, 0.0, np.pi / 2, -np.radians(bend)], SLIDES)


def test_half_the_bend_of_an_upright_arm_takes_twice_the_velocities():
    up = np.array([0.0, 0.0, 0.1])
    for bend in (4.0, 1.0, 0.1):
        one, half = (np.abs(minimum_norm(upright(x), up)).max() for x in (bend, bend / 2))
        assert half / one == pytest.approx(2, rel=0.01)
    assert np.linalg.matrix_rank(upright(0.0)) == 2


def test_damped_velocities_have_a_bound_wherever_they_are_asked(rng):
    largest = 0.0
    for damping in (0.02, 0.05):
        for q in [
            *rng.uniform(-3, 3, (200, 6)),
            *np.c_[np.zeros((50, 4)), rng.normal(size=(50, 2))],
        ]:
            J, b = jacobian(q, SLIDES), rng.normal(size=3)
            v = minimum_norm(J, b, damping=damping)
            largest = max(largest, 2 * damping * np.linalg.norm(v) / np.linalg.norm(b))
        for bend in np.geomspace(0.01, 30, 60):
            v = minimum_norm(upright(bend), [0.0, 0.0, 0.1], damping=damping)
            largest = max(largest, 2 * damping * np.linalg.norm(v) / 0.1)
            assert (upright(bend) @ v)[2] < 0.1
    assert 0.9 < largest <= 1 + 1e-9


def test_two_motions_are_left_to_choose(rng):
    for q in rng.uniform(-1.2, 1.2, (20, 6)):
        J = jacobian(q, SLIDES)
        assert np.linalg.matrix_rank(null_projector(J), tol=1e-9) == 2
        assert_allclose(J @ null_projector(J), 0, atol=1e-12)


@pytest.mark.parametrize("W", [0.3, 0.9])
def test_half_the_step_leaves_a_quarter_of_the_error(W):
    errors = [left("ring", T, W) for T in (0.1, 0.05, 0.025)]
    for one, half in pairwise(errors):
        assert one / half == pytest.approx(4, rel=0.06)


def test_gains_near_one_leave_more():
    assert left("ring", 0.025, 0.9) / left("ring", 0.025, 0.3) == pytest.approx(7, rel=0.05)


def test_drives_that_lag_swing_with_quick_gains_and_trail_with_slow_ones():
    assert overshoot(0.1, 0.2, 0.0) == pytest.approx(0.05, rel=0.05)
    assert overshoot(0.97, 0.2, 0.0) < 1e-3
    assert left("ring", 0.1, 0.9, 0.2) > 8 * left("ring", 0.1, 0.1, 0.2)


def test_steering_the_place_of_rest_takes_swing_and_trail_away():
    assert overshoot(0.1, 0.2, 0.2) < 1e-4
    assert left("ring", 0.1, 0.9, 0.2, 0.2) < 0.1 * left("ring", 0.1, 0.9, 0.2)
    assert left("ring", 0.1, 0.1, 0.2, 0.2) < 0.5 * left("ring", 0.1, 0.1, 0.2)


def largest_error(plant, lag=0.0):
    """Of the machine's tip along the lesson's eight [m]."""
    posture, weights = np.array([-np.pi / 2, 0.4, 0.0, 0.7]), [3.0, 3, 1, 1, 1, 1]

    def pull(q):
        return np.array([0.0, 0.0, *(0.3 * (posture - q[3:]))])

    def solve(J, b, v0):
        return minimum_norm(J, b, weights=weights) + null_projector(J) @ v0

    path = eight_path(hand([0.0, 0.0, 0.0, *posture]), 20, length=6, width=3, height=1.5)
    if plant is None:
        plant = KinematicPlant(BACKHOE, [0.0, 0.0, 0.0, *posture], dt=0.1)
    else:
        plant.world.reset(posture)
        plant.wake()
    return follow(plant, path, W=0.5, preferred=pull, solve=solve, lag=lag).error.max()


def test_the_machines_drives_double_the_error_and_their_lag_explains_most_of_it():
    ideal, found = largest_error(None), {}
    backends = ["analytic"] + ["pybullet"] * (find_spec("pybullet") is not None)
    for backend in backends:
        errors = []
        for lag in (0.0, [0.1, 0.1, 0, 0, 0, 0]):
            with simulation.open_world(backend=backend) as world:
                errors.append(largest_error(WholeBodyPlant(world, dt=0.1), lag))
        assert errors[0] == pytest.approx(2 * ideal, rel=0.1)
        assert errors[1] - ideal < 0.2 * (errors[0] - ideal)
        found[backend] = errors
    assert_allclose(found["analytic"], found[backends[-1]], atol=2e-4)


def test_half_of_the_lag_leaves_a_fifth_of_the_swing():
    assert overshoot(0.1, 0.2, 0.1) / overshoot(0.1, 0.2, 0.0) == pytest.approx(0.2, abs=0.02)


def bends(path, preferred):
    return -np.degrees(run(path, 0.2, 0.5, 140.0, preferred).q[:, 5])


def test_a_closed_path_of_the_hand_opens_the_joints_until_the_arm_is_straight():
    assert_allclose(PATHS["ring"](140.0), PATHS["ring"](0.0), atol=1e-9)
    least, kept = bends("ring", None), bends("ring", back)
    assert least[: 4 * 100].min() > 10 > 1 > np.abs(least[4 * 100 : 5 * 100]).min()
    assert 60 < kept.min() and kept.max() < 90


def test_least_velocities_are_least_now_and_cost_more_later():
    fastest = {
        (path, preferred): np.abs(run(path, 0.2, 0.5, 140.0, preferred).told).max()
        for path in ("ring", "sine")
        for preferred in (None, back)
    }
    assert fastest["ring", None] > 2.5 * fastest["ring", back]
    assert fastest["sine", None] < 0.8 * fastest["sine", back]
