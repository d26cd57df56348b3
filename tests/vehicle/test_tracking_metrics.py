"""Distances to a polyline and the metrics made of them."""

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from backhoe.vehicle import tracking

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]], float)
ZIGZAG = np.array([[0, 0], [1, 0], [1, 0], [0.2, 0.9], [3, 3], [3, 3], [-1, 2], [0.5, 0.5]], float)
points = arrays(float, (5, 2), elements=st.floats(-10, 10, allow_subnormal=False))


def test_the_distance_is_to_the_segments_not_to_their_ends():
    line = [[0, 0], [10, 0]]
    assert tracking.distances([[5, 1], [5, -2], [0, 3]], line).tolist() == [1.0, 2.0, 3.0]


def test_beyond_the_ends_the_distance_is_to_the_end():
    assert tracking.distances([[-3, 4], [13, 4]], [[0, 0], [10, 0]]).tolist() == [5.0, 5.0]


def test_distances_to_a_square_are_those_of_geometry():
    x, y = np.random.default_rng(1).uniform(-1, 2, (2, 500))
    outside = np.hypot(np.maximum(np.maximum(-x, x - 1), 0), np.maximum(np.maximum(-y, y - 1), 0))
    inside = np.minimum(np.minimum(x, 1 - x), np.minimum(y, 1 - y))
    expected = np.where(inside > 0, inside, outside)
    np.testing.assert_allclose(tracking.distances(np.c_[x, y], SQUARE), expected, atol=1e-15)


def test_distances_to_a_fine_circle_are_those_to_the_circle():
    p = np.random.default_rng(2).normal(size=(300, 2))
    circle = tracking.circle(1.5, points=4000).points
    expected = np.abs(np.hypot(*p.T) - 1.5)
    np.testing.assert_allclose(
        tracking.distances(p, circle), expected, atol=1.5 * (np.pi / 4000) ** 2
    )


def test_sampling_the_polyline_ever_finer_converges_to_the_distance_from_above():
    p = np.random.default_rng(3).uniform(-2, 4, (200, 2))
    exact = tracking.distances(p, ZIGZAG)
    spacing = tracking.length(ZIGZAG) / (np.array([30, 300, 3000, 30000]) - 1)
    for samples, gap in zip((30, 300, 3000, 30000), spacing, strict=True):
        sampled = tracking.distances_to_samples(p, ZIGZAG, samples)
        assert (sampled >= exact - 1e-12).all()
        assert (sampled - exact).max() <= gap / 2 + 1e-12


def test_the_vertices_alone_would_give_a_larger_distance():
    p = [[0.5, 0.1]]
    assert tracking.distances(p, SQUARE)[0] == pytest.approx(0.1)
    assert np.min(np.hypot(*(SQUARE - p).T)) == pytest.approx(np.hypot(0.5, 0.1))


@given(points, points)
def test_distances_do_not_depend_on_direction_or_on_repeated_points(p, line):
    d = tracking.distances(p, line)
    np.testing.assert_allclose(tracking.distances(p, line[::-1]), d, atol=1e-9)
    np.testing.assert_allclose(tracking.distances(p, np.repeat(line, 2, axis=0)), d, atol=1e-12)


@given(points, points, st.floats(-np.pi, np.pi))
def test_distances_do_not_change_when_all_is_turned_and_shifted(p, line, angle):
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    moved = tracking.distances(p @ turn.T + [3, -2], line @ turn.T + [3, -2])
    np.testing.assert_allclose(moved, tracking.distances(p, line), atol=1e-9)


@given(points)
def test_points_of_the_polyline_have_no_distance_to_it(line):
    mids = (line[1:] + line[:-1]) / 2
    np.testing.assert_allclose(tracking.distances(np.vstack([line, mids]), line), 0, atol=1e-14)


@pytest.mark.parametrize("tiny", [1e-170, 1e-155, 1e-100, 5e-324])
def test_segments_of_almost_no_length_do_no_harm(tiny):
    line = np.array([[0, 0], [tiny, 0], [1, 0]])
    np.testing.assert_allclose(tracking.distances([[0.5, 2.0], [-3, 4]], line), [2.0, 5.0])
    np.testing.assert_allclose(tracking.distances([[3, 4]], line[:2]), [5.0])


def test_a_hundred_thousand_points_against_a_thousand_segments_stay_within_memory():
    rng = np.random.default_rng(4)
    p, line = rng.normal(size=(100_000, 2)), np.cumsum(rng.normal(size=(1001, 2)), axis=0)
    tracemalloc.start()
    d = tracking.distances(p, line)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 20e6
    some = rng.integers(0, len(p), 50)
    np.testing.assert_array_equal(d[some], tracking.distances(p[some], line))


def test_metrics_of_a_shifted_line_are_those_on_paper():
    actual = np.c_[np.linspace(0, 4, 5), [0.0, 1.0, 2.0, 3.0, 4.0]]
    m = tracking.metrics(actual, [[0, 0], [4, 0]])
    assert m.d_mean == pytest.approx(2.0)
    assert m.d_std == pytest.approx(np.sqrt(2.0))
    assert m.d_max == pytest.approx(4.0)
    assert m.d_ratio == pytest.approx(np.sqrt(2.0))


def test_a_perfect_run_has_no_distance_and_ratio_one():
    path = tracking.figure_eight()
    m = tracking.metrics(path.resample(0.01).points, path.points)
    np.testing.assert_allclose(m, [0, 0, 0, 1], atol=1e-12)


def test_the_ideal_ratio_of_the_circle_started_at_its_centre_is_more_than_the_source_prints():
    from backhoe.lessons import published

    path = tracking.circle(1.5, points=4000)
    m = tracking.metrics(np.vstack([[0, 0], path.points]), path.points)
    assert m.d_ratio == pytest.approx(1 + 1 / (2 * np.pi), rel=1e-5)
    assert m.d_max == pytest.approx(1.5, rel=1e-6)
    table = published.load("dangelo_2022_table_51")
    assert all(table[kind]["circle"]["d_ratio"] < m.d_ratio - 0.07 for kind in ("P", "PI"))


def test_one_actual_point_has_metrics_and_one_reference_point_has_none():
    assert tracking.metrics([[0.5, 1]], [[0, 0], [1, 0]]) == (1.0, 0.0, 1.0, 0.0)
    with pytest.raises(ValueError, match="reference needs 2 points or more, got 1"):
        tracking.metrics([[0, 0], [1, 1]], [[0, 0]])


@pytest.mark.parametrize(
    ("actual", "reference", "message"),
    [
        (np.empty((0, 2)), SQUARE, r"actual must be x, y .* got shape \(0, 2\)"),
        ([[0, 0, 0]], SQUARE, r"actual must be x, y .* shape \(n, 2\)"),
        ([0, 0], SQUARE, r"actual must be x, y .* shape \(n, 2\)"),
        ([[np.nan, 0]], SQUARE, r"actual must be finite, got nan at index \(0, 0\)"),
        (SQUARE, [[0, 0], [1, np.inf]], r"reference must be finite, got inf at index \(1, 1\)"),
        (SQUARE, [["a", "b"]], "reference must be numbers"),
        (SQUARE, [[1, 1], [1, 1]], "reference must go somewhere"),
    ],
)
def test_metrics_name_what_is_wrong(actual, reference, message):
    with pytest.raises(ValueError, match=message):
        tracking.metrics(actual, reference)


@pytest.mark.parametrize("samples", [1, 2.5, True, "many"])
def test_a_number_of_samples_is_a_whole_number(samples):
    with pytest.raises(ValueError, match="samples must be one whole number at least 2"):
        tracking.distances_to_samples(SQUARE, SQUARE, samples)


def _run(path, positions, time, command=None):
    n = len(time)
    command = np.zeros((n, 2)) if command is None else command
    pose = np.c_[positions, np.zeros(n)]
    return tracking.Follow(
        time, pose, np.zeros((n, 2)), command, np.zeros((n, 2)), path, "trajectory", True
    )


@settings(max_examples=20)
@given(st.floats(-3.0, 3.0))
def test_the_lag_of_a_run_that_is_only_late_is_found(delay):
    path = tracking.figure_eight(points=400).with_times(0.5)
    time = np.arange(0, path.end_time, 0.05)
    run = _run(path, path.position(time - delay), time)
    assert tracking.time_lag(run) == pytest.approx(delay, abs=2e-3)


def test_the_time_error_of_a_late_run_on_a_line_is_its_speed_times_its_delay():
    path = tracking.from_points([[0, 0], [10, 0]]).with_times(0.5)
    time = np.linspace(2.0, 18.0, 33)
    a = tracking.assess(_run(path, path.position(time - 2.0), time))
    assert a.time_error_mean == pytest.approx(1.0)
    assert a.time_error_max == pytest.approx(1.0)
    assert a.lag == pytest.approx(2.0, abs=1e-3)
    assert a.d_max == pytest.approx(0.0, abs=1e-14)


def test_the_effort_is_the_integral_of_the_squares_and_the_change_the_sum_of_the_steps():
    path = tracking.from_points([[0, 0], [1, 0]]).with_times(0.1)
    time = np.array([0.0, 0.5, 1.0, 2.0])
    command = np.array([[1.0, -2.0], [3.0, 0.0], [-1.0, 0.0], [-1.0, 0.0]])
    a = tracking.assess(_run(path, np.zeros((4, 2)), time, command))
    assert a.effort_v == pytest.approx(0.5 * 1 + 0.5 * 9 + 1 * 1)
    assert a.effort_omega == pytest.approx(0.5 * 4)
    assert a.change_v == pytest.approx(2 + 4)
    assert a.change_omega == pytest.approx(2)


def test_a_run_in_path_mode_has_no_time_error():
    run = tracking.follow(tracking.TRACKERS["P"](), tracking.IdealPlant(), tracking.square(1.0))
    a = tracking.assess(run)
    assert np.isnan([a.time_error_mean, a.time_error_max, a.lag]).all()
    assert a[:4] == run.metrics
