"""Secondary tasks: what the null space is asked for, and what it cannot promise."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from backhoe.whole_body import (
    BACKHOE,
    SLIDES,
    from_limits,
    hand,
    jacobian,
    length_weights,
    manipulability,
    minimum_norm,
    to_manipulability,
    to_posture,
)

ROBOTS = pytest.mark.parametrize("robot", [SLIDES, BACKHOE], ids=["slides", "backhoe"])


@pytest.fixture
def rng():
    return np.random.default_rng(12)


def postures(rng, robot, *shape):
    return rng.uniform(-1.2, 1.2, (*shape, 3 + robot.joints))


def drive(q, v, dt):
    """Exactly along the arc that u and omega drive, and with steady joints."""
    u, omega = v[:2]
    middle, chord = q[2] + omega * dt / 2, u * dt * np.sinc(omega * dt / 2 / np.pi)
    return q + np.r_[chord * np.cos(middle), chord * np.sin(middle), dt * v[1:]]


def standing(q, prefer, robot, steps, dt=0.02):
    """Postures while the hand stands, brought back to its place each step."""
    place, way = hand(q, robot), [q]
    for _ in range(steps):
        b = 0.5 * (place - hand(q, robot)) / dt
        q = drive(q, minimum_norm(jacobian(q, robot), b, prefer(q)), dt)
        way.append(q)
    way = np.array(way)
    assert np.abs(hand(way, robot) - place).max() < 2e-3
    return way


def arm_w(way, robot):
    return manipulability(jacobian(way, robot)[..., 2:])


@ROBOTS
def test_many_postures_at_once_and_no_word_about_the_platform(robot, rng):
    q, n = postures(rng, robot, 2, 3), robot.joints
    low, high = -np.arange(1.0, n + 1), np.ones(n)
    for task in (
        lambda q: to_posture(q, np.arange(n) / 5, 0.7, robot),
        lambda q: to_posture(q, np.zeros(n), np.arange(n), robot),
        lambda q: to_manipulability(q, 2.0, robot),
        lambda q: from_limits(q, low, high, 3.0, robot),
    ):
        v0 = task(q)
        assert v0.shape == (2, 3, 2 + n) and (v0[..., :2] == 0).all()
        assert_allclose(v0[1, 2], task(q[1, 2]), atol=1e-14)


@ROBOTS
def test_each_is_the_gradient_of_what_it_wants(robot, rng):
    q, n = postures(rng, robot), robot.joints
    low, high = rng.uniform(-3, -2, n), rng.uniform(1, 3, n)
    wanted = rng.uniform(-1, 1, n)
    weights = length_weights(robot)[2:]
    wishes = [
        (to_posture(q, wanted, 0.7, robot), lambda a: -0.7 * ((a - wanted) ** 2).sum() / 2),
        (
            from_limits(q, low, high, 3.0, robot),
            lambda a: -3.0 * np.mean(((a - (low + high) / 2) / (high - low)) ** 2) / 2,
        ),
        (
            to_manipulability(q, 2.0, robot),
            lambda a: 2 * manipulability(jacobian(np.r_[q[:3], a], robot)[:, 2:], weights),
        ),
    ]
    for v0, wish in wishes:
        steps = 1e-5 * np.eye(n)
        differences = [(wish(q[3:] + s) - wish(q[3:] - s)) / 2e-5 for s in steps]
        assert_allclose(v0[2:], differences, rtol=1e-6, atol=1e-8)


def test_a_posture_is_reached_while_the_hand_stands(rng):
    start = np.array([0, 0, 0.3, 0.6, 0.9, -1.2])
    wanted = np.array([0.0, 1.3, -1.9])
    way = standing(start, lambda q: to_posture(q, wanted, 1.0, SLIDES), SLIDES, 1500)
    before, after = (np.abs(q[3:] - wanted).max() for q in (way[0], way[-1]))
    assert after < before / 4


@ROBOTS
def test_the_arm_s_manipulability_grows_while_the_hand_stands(robot, rng):
    q = np.array([0, 0, 0.3, 0.6, 0.7, -0.3, -0.4][: 3 + robot.joints])
    way = standing(q, lambda q: to_manipulability(q, 1.0, robot), robot, 400)
    w = arm_w(way, robot)
    assert (np.diff(w) > -1e-5 * w[0]).all() and w[-1] > 1.2 * w[0]


def test_going_from_limits_is_a_wish_and_keeps_none():
    """The hand pulls q2 through its limit; the wish only slows that down."""
    low, high = np.array([-1.0, 0.4, -2.0]), np.array([1.0, 1.4, -0.5])
    beyond = []
    for gain in (0.0, 1.0):
        q = np.array([0, 0, 0.0, 0.0, 1.2, -1.0])
        for _ in range(300):
            v0 = from_limits(q, low, high, gain, SLIDES)
            q = drive(q, minimum_norm(jacobian(q, SLIDES), [0, 0, -0.12], v0), 0.02)
        beyond.append((low - q[3:])[1])
    assert 0 < beyond[1] < beyond[0]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: to_posture(np.zeros(6), np.zeros(4), 1, SLIDES), "wanted must"),
        (lambda: to_posture(np.zeros(6), np.zeros(3), -1, SLIDES), "gain must be .* 0 or more"),
        (lambda: to_posture(np.zeros(6), np.zeros(3), [1, 1], SLIDES), "gain must be"),
        (lambda: to_manipulability(np.zeros(6), -1, SLIDES), "gain"),
        (lambda: from_limits(np.zeros(6), np.ones(3), np.ones(3), 1, SLIDES), "lowest must be b"),
        (lambda: from_limits(np.zeros(7), np.zeros(3), np.ones(3), 1, SLIDES), "q must"),
    ],
)
def test_bad_input_is_told(call, message):
    with pytest.raises(ValueError, match=message):
        call()
