"""A path in time: within speeds and accelerations, and as fast as closed forms allow."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from backhoe.planning.search import in_time, segment_times

SPEED, MOST = np.array([1.1, 0.7, 1.0, 1.5]), np.array([0.8, 1.4, 1.0, 0.7])


def path(seed, points=5):
    return np.cumsum(np.random.default_rng(seed).normal(size=(points, 4)), axis=0)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("piece", [1.0, 0.2])
def test_no_joint_is_too_fast_or_gains_speed_too_fast_and_it_rests_at_the_ends(seed, piece):
    given = path(seed, 2 + seed)
    times, q, dq = in_time(given, SPEED, MOST, piece=piece)
    assert_allclose(q[[0, -1]], given[[0, -1]], atol=1e-12)
    assert_allclose(dq[[0, -1]], 0.0, atol=1e-9)
    assert (np.abs(dq) <= SPEED * (1 + 1e-9)).all()
    assert (np.abs(np.diff(dq, axis=0)) <= MOST * times[1] * (1 + 1e-9)).all()
    assert_allclose(np.diff(q, axis=0) / times[1], (dq[1:] + dq[:-1]) / 2, atol=0.02)
    assert_allclose(np.diff(times), times[1])


@pytest.mark.parametrize("way", [0.1, 1.0, 6.0])
def test_one_joint_alone_takes_the_time_of_a_trapezium(way):
    given = np.array([[0.0], [way]])
    v, a = 1.1, 0.8
    least = 2 * np.sqrt(way / a) if way < v * v / a else way / v + v / a
    times, _, dq = in_time(given, [v], [a])
    assert least - 1e-9 <= times[-1] < 1.02 * least
    assert np.abs(dq).max() == pytest.approx(min(v, np.sqrt(way * a)), rel=0.02)


def test_shorter_pieces_keep_nearer_to_the_corners():
    given = np.array([[0, 0, 0, 0], [1, 0, 0, 0], [1, 1, 0, 0.0]])
    off = []
    for piece in (1.0, 0.5, 0.25, 0.125):
        q = in_time(given, SPEED, MOST, piece=piece).q
        off.append(np.linalg.norm(q - given[1], axis=1).min())
    assert (np.diff(off) < 0).all() and off[-1] < 0.05


def test_pieces_are_halved_until_the_rounded_corner_is_free():
    given = np.array([[0, 0, 0, 0], [1, 0, 0, 0], [1, 1, 0, 0.0]])

    def is_free(q):
        return np.linalg.norm(q[:, :2] - [0.7, 0.3], axis=1) > 0.27

    assert not is_free(in_time(given, SPEED, MOST).q).all()
    assert is_free(in_time(given, SPEED, MOST, is_free=is_free).q).all()
    with pytest.raises(ValueError, match="no rounding of it is"):
        in_time(given, SPEED, MOST, is_free=lambda q: q[:, 0] < 0.5)


def test_a_point_twice_costs_nothing_and_no_way_takes_no_time():
    given = path(3)
    twice = np.repeat(given, 2, axis=0)
    assert_allclose(in_time(twice, SPEED, MOST).q, in_time(given, SPEED, MOST).q)
    assert_allclose(segment_times(twice, SPEED)[1::2], segment_times(given, SPEED))
    still = in_time(given[[0, 0]], SPEED, MOST)
    assert still.times == [0.0] and still.dq.shape == (1, 4)


@pytest.mark.parametrize(
    "change, words",
    [
        ({"path": [[0, 0, 0, 0]]}, "2 or more points"),
        ({"path": [[0, 0, 0, np.nan], [1, 1, 1, 1]]}, "finite"),
        ({"speed_limit": [1, 1, 1]}, "speed_limit"),
        ({"speed_limit": [1, 1, 1, 0]}, "speed_limit"),
        ({"acceleration_limit": [1, 1, 1, -1]}, "acceleration_limit"),
        ({"dt": 0}, "dt"),
        ({"piece": 0}, "piece"),
    ],
)
def test_bad_input_is_named(change, words):
    given = {"path": path(0), "speed_limit": SPEED, "acceleration_limit": MOST, **change}
    with pytest.raises(ValueError, match=words):
        in_time(**given)
