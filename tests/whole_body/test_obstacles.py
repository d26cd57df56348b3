"""Obstacles: the terms that the slides print, and those that keep clear."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from backhoe.whole_body import (
    BACKHOE,
    SLIDES,
    SlidesRobot,
    clearance,
    hand,
    jacobian,
    keep_clear,
    limited_velocity,
    minimum_norm,
    steer_clear,
    to_posture,
    wanted_velocity,
)

ROBOTS = pytest.mark.parametrize("robot", [SLIDES, BACKHOE], ids=["slides", "backhoe"])
MEND = {"within": 0.7, "brake": 0.2, "turn": 4.0, "size": 0.3, "robot": SLIDES}
POSTURE = np.array([0.0, 1.2, -1.6])
POST = np.array([1.5, 0.0])


@pytest.fixture
def rng():
    return np.random.default_rng(12)


def drive(q, v, dt):
    """Exactly along the arc that u and omega drive, and with steady joints."""
    u, omega = v[..., 0], v[..., 1]
    middle, chord = q[..., 2] + omega * dt / 2, u * dt * np.sinc(omega * dt / 2 / np.pi)
    moved = np.stack([chord * np.cos(middle), chord * np.sin(middle)], axis=-1)
    return q + np.concatenate([moved, dt * v[..., 1:]], axis=-1)


def postures(rng, robot, *shape):
    return rng.uniform(-1.2, 1.2, (*shape, 3 + robot.joints))


@ROBOTS
@pytest.mark.parametrize("dimensions", [2, 3], ids=["platform", "arm"])
def test_distances_change_as_they_say(robot, dimensions, rng):
    q, obstacles = postures(rng, robot, 2, 3), rng.uniform(-4, 4, (5, dimensions))
    distance, change = clearance(q, obstacles, size=0.2, robot=robot)
    pairs = 5 * (1 if dimensions == 2 else 2 * robot.joints - 1)
    assert distance.shape == (2, 3, pairs) and change.shape == (2, 3, pairs, 2 + robot.joints)
    one = clearance(q[1, 2], obstacles, size=0.2, robot=robot)
    assert_allclose(one.distance, distance[1, 2]), assert_allclose(one.change, change[1, 2])
    v, dt = rng.normal(size=2 + robot.joints), 1e-5
    ahead, back = (
        clearance(drive(q[1, 2], v, way * dt), obstacles, size=0.2, robot=robot).distance
        for way in (1, -1)
    )
    assert_allclose(one.change @ v, (ahead - back) / (2 * dt), atol=1e-7)


def test_the_arms_points_are_its_hinges_middles_and_hand():
    q = np.array([1.0, 2.0, 0.3, 0.5, 0.7, -0.4])
    robot, outward = SLIDES, np.array([np.cos(0.8), np.sin(0.8)])
    shoulder = np.r_[1 + 0.2 * np.cos(0.3), 2 + 0.2 * np.sin(0.3), 0.4]
    elbow = shoulder + robot.l2 * np.r_[np.cos(0.7) * outward, np.sin(0.7)]
    tip = hand(q, robot)
    points = np.array([shoulder, elbow, tip, (shoulder + elbow) / 2, (elbow + tip) / 2])
    found = clearance(q, points, robot=robot).distance.reshape(5, 5)
    assert_allclose(found, np.linalg.norm(points[:, None] - points, axis=-1), atol=1e-12)


def at(bearing, distance):
    q = np.array([0.5, -0.3, 0.4, 0, 1.2, -1.6])
    post = q[:2] + distance * np.array([np.cos(0.4 + bearing), np.sin(0.4 + bearing)])
    return q, post[None]


def avoiding(bearing, distance, **other):
    q, post = at(bearing, distance)
    return steer_clear(q, post, **(MEND | other))


def test_it_brakes_turns_away_and_has_an_end():
    for bearing in (0.2, 0.9, 1.4):
        u, omega = avoiding(bearing, 0.6)[:2]
        assert u == pytest.approx(-0.2 * (1 - 0.3 / 0.7) * np.cos(bearing)) and omega < 0
        assert_allclose(avoiding(-bearing, 0.6)[:2], [u, -omega])
        assert_allclose(avoiding(np.pi - bearing, 0.6, forwards=False)[:2], [-u, -omega])
    assert_allclose(avoiding(0.0, 0.3)[:2], [-0.2, -4.0])
    for bearing, distance in ((0, 1.0), (0.3, 7.0), (np.pi / 2, 0.5), (2.0, 0.4), (np.pi, 0.31)):
        assert_allclose(avoiding(bearing, distance), 0, atol=1e-12)


def test_it_is_continuous_but_for_the_side(rng):
    for bearing, distance in zip(
        rng.uniform(1e-3, np.pi, 300), rng.uniform(0, 1.2, 300), strict=True
    ):
        near = avoiding(bearing + 1e-6, distance + 1e-6) - avoiding(bearing, distance)
        assert np.abs(near).max() < 4 * 1e-5 / max(distance, 0.3)


def test_several_obstacles_add_up_and_many_postures_go_at_once(rng):
    q, posts = postures(rng, SLIDES, 3, 2), rng.uniform(-1, 1, (4, 2))
    found = steer_clear(q, posts, **MEND)
    each = sum(steer_clear(q, post[None], **MEND) for post in posts)
    assert_allclose(found, each, atol=1e-14)
    assert_allclose(found[2, 1], steer_clear(q[2, 1], posts, **MEND), atol=1e-14)


def passing(starts, avoid, robot=SLIDES, k=1.0, speed=0.2, steps=300):
    """Hands of robots k times as large go straight, most of them over the post.

    What distance is left at least, over k.
    """
    q, T = np.array([[0, k * y, heading, *POSTURE] for y, heading in starts]), 0.01 / speed
    way = np.stack([np.cos(q[:, 2]), np.sin(q[:, 2]), 0 * q[:, 2]], axis=-1)
    goal, on, least = hand(q, robot), 0.01 * k * way, np.full(len(q), np.inf)
    for _ in range(steps):
        J, b = jacobian(q, robot), wanted_velocity(hand(q, robot), goal, goal + on, 0.3, T)
        v = minimum_norm(J, b, to_posture(q, POSTURE, 1.5 * speed, robot) + avoid(q))
        assert_allclose((J @ v[..., None])[..., 0], b, atol=1e-9)
        q, goal = drive(q, v, T), goal + on
        assert np.abs(goal - hand(q, robot)).max() < 3e-3 * k
        there = clearance(q, k * POST[None], size=0.3 * k, robot=robot)
        least = np.minimum(least, there.distance[:, 0] / k)
    return least


def printed(q, k_u, k_omega, r=1.0):
    apart = POST - q[:, :2]
    d, alpha = np.hypot(*apart.T), np.arctan2(apart[:, 1], apart[:, 0]) - q[:, 2]
    alpha = (alpha + np.pi) % (2 * np.pi) - np.pi
    v0 = np.zeros((len(q), 5))
    v0[:, 0] = k_u * (r - d) * (np.pi / 2 - abs(alpha)) * (d < r)
    v0[:, 1] = k_omega * (r - d) * np.sign(alpha) * (np.pi / 2 - abs(alpha)) * (d < r)
    return v0


STARTS = [(0, 0), (1e-9, 0), (-1e-9, 0), *np.random.default_rng(3).uniform(-0.2, 0.2, (60, 2))]


@pytest.mark.parametrize("speed", [0.1, 0.4])
@pytest.mark.parametrize(
    ("robot", "k"),
    [(SLIDES, 1.0), (SlidesRobot(0.1, 0.3, 0.4, 0.3), 1.2), (SlidesRobot(0.4, 0.8, 0.9, 0.7), 2.6)],
)
def test_platforms_get_past_a_post_while_their_hands_stay_on_their_way(robot, k, speed):
    for within in (0.5 * k, 0.9 * k):
        gains = {"brake": speed * k, "turn": 15 * speed * k / within}

        def avoid(q, within=within, gains=gains):
            post = k * POST[None]
            return steer_clear(q, post, within=within, size=0.3 * k, robot=robot, **gains)

        assert (passing(STARTS, avoid, robot, k, speed) > 0.02).all()


@pytest.mark.parametrize("signs", [(1, 1), (-1, 1), (1, -1), (-1, -1)], ids=str)
def test_with_the_printed_terms_and_any_signs_it_runs_over_one_dead_ahead(signs):
    least = passing(STARTS, lambda q: printed(q, 0.5 * signs[0], 2.0 * signs[1]))
    assert least[0] < -0.25 and (least < 0).mean() > (0.9 if signs[1] > 0 else 0.3)


def along_with_limits(wish, steps=300, T=0.05, speed=0.2):
    """The hand goes straight over the post, as far as the distance to it allows: s of each step."""
    q, top, shares = np.r_[0, 0, 0, POSTURE], np.full(5, 2.0), []
    start = hand(q, SLIDES)
    for _ in range(steps):
        distance, change = clearance(q, POST[None], size=0.3, robot=SLIDES)
        J, gone = jacobian(q, SLIDES), np.array([speed * T * sum(shares), 0, 0])
        b = wanted_velocity(hand(q, SLIDES), start + gone, start + gone + [speed * T, 0, 0], 0.3, T)
        v, s = limited_velocity(J, b, -top, top, preferred=wish(q), A=-change, c=2 * distance)
        assert_allclose(J @ v, s * b, atol=1e-9)
        q = drive(q, v, T)
        assert clearance(q, POST[None], size=0.3, robot=SLIDES).distance > 0
        shares.append(s)
    return np.array(shares), q


def home(q):
    return to_posture(q, POSTURE, 0.3, SLIDES)


def test_a_limit_keeps_the_distance_and_holds_the_hand_instead():
    shares, q = along_with_limits(home)
    assert shares[0] == pytest.approx(1, abs=1e-3) and shares[-1] < 0.05
    assert q[0] == pytest.approx(1.2, abs=1e-3)


def test_limit_and_wish_together_get_past_without_a_stop():
    shares, q = along_with_limits(lambda q: home(q) + steer_clear(q, POST[None], **MEND))
    assert (shares > 0.99).all() and q[0] > 2.5


def test_a_limit_keeps_the_arm_off_a_ball():
    q = np.array([0, 0, 0, 0.4, 0.9, -0.9])
    ball, top = elbow(q, SLIDES) - np.array([0, 0, 0.2]), np.full(5, 2.0)
    least = {True: np.inf, False: np.inf}
    for limited in least:
        at = q
        for _ in range(150):
            distance, change = clearance(at, ball[None], size=0.1, robot=SLIDES)
            rows = {"A": -change, "c": 2 * distance} if limited else {}
            down = np.array([0, 0, -0.1])
            at = drive(at, limited_velocity(jacobian(at, SLIDES), down, -top, top, **rows).v, 0.02)
            now = clearance(at, ball[None], size=0.1, robot=SLIDES).distance.min()
            least[limited] = min(least[limited], now)
    assert least[False] < -0.02 and least[True] > 0


def elbow(q, robot):
    """The second of the arm's points, from its distances to four others."""
    others = np.vstack([np.zeros(3), np.eye(3)])
    d = clearance(q, others, robot=robot).distance.reshape(-1, 4)[1]
    return (d[0] ** 2 - d[1:] ** 2 + 1) / 2


@ROBOTS
def test_an_elbow_is_pushed_off_while_the_hand_stands(robot):
    q = np.array([0, 0, 0.3, 0.4, 0.9, -0.9, -0.8][: 3 + robot.joints])
    k = 1.0 if robot is SLIDES else 8.0  # the machine is so much larger
    place, ball = hand(q, robot), elbow(q, robot) - np.array([0, 0, 0.08 * k])
    settings = {"size": 0.05 * k, "robot": robot}
    before = np.linalg.norm(elbow(q, robot) - ball)
    for _ in range(150):
        v0 = keep_clear(q, ball[None], within=0.2 * k, speed=0.4 * k, **settings)
        b = 0.5 * (place - hand(q, robot)) / 0.02
        q = drive(q, minimum_norm(jacobian(q, robot), b, v0), 0.02)
    assert np.linalg.norm(elbow(q, robot) - ball) > before + 0.03 * k
    assert_allclose(hand(q, robot), place, atol=1e-3 * k)
    assert (keep_clear(q, ball[None] + 50, within=1.0, speed=1.0, robot=robot) == 0).all()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda q: steer_clear(q, [[1, 2, 3]], **MEND), "obstacles must"),
        (lambda q: steer_clear(q, [[1, 2]], **MEND | {"within": 0}), "within"),
        (lambda q: steer_clear(q, [[1, 2]], **MEND | {"turn": -1}), "turn"),
        (lambda q: keep_clear(q, [[1, 2]], within=1, speed=1, robot=SLIDES), "obstacles must"),
        (lambda q: clearance(q, [[1, 2, 3, 4]], robot=SLIDES), "obstacles must"),
        (lambda q: clearance(q, [[1, np.nan]], robot=SLIDES), "obstacles must be finite"),
        (lambda q: clearance(q, [[1, 2]], size=-1, robot=SLIDES), "size"),
    ],
)
def test_bad_input_is_told(call, message):
    with pytest.raises(ValueError, match=message):
        call(np.zeros(6))
