"""Paths, geometries and way-point files."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from backhoe.vehicle import tracking
from backhoe.vehicle.tracking import Path


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([], r"shape \(n, 2\)"),
        ([[0.0, 0.0]], "2 points or more, got 1"),
        ([[0, 0, 0], [1, 1, 1]], r"shape \(n, 2\)"),
        ([[0, 0], [np.nan, 1]], r"got nan at index \(1, 0\)"),
        ([[0, 0], ["a", "b"]], "must be numbers"),
        ([[0, 0], [1j, 0]], "must be numbers"),
        ([[2.0, 3.0], [2.0, 3.0]], "must go somewhere"),
    ],
)
def test_a_path_refuses_points_that_are_none(points, message):
    with pytest.raises(ValueError, match=message):
        Path(points)


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ([0.0, 1.0], "one for each of 3 points"),
        ([0.0, 2.0, 2.0], "2.0 s at index 1 is followed by 2.0 s"),
        ([0.0, 2.0, 1.0], "times must rise"),
        ([0.0, np.nan, 1.0], "times must be finite"),
        ([-1.0, 0.0, 1.0], "0 or later"),
        (["a", "b", "c"], "must be numbers"),
    ],
)
def test_a_trajectory_refuses_times_that_do_not_rise(times, message):
    with pytest.raises(ValueError, match=message):
        Path([[0, 0], [1, 0], [1, 1]], times)


def test_a_path_keeps_its_own_copy_that_nobody_can_change():
    points = np.array([[0.0, 0.0], [1.0, 0.0]])
    path = Path(points)
    points[0] = 9.0
    assert path.points[0].tolist() == [0.0, 0.0]
    with pytest.raises(ValueError, match="read-only"):
        path.points[0] = 1.0


def test_the_printed_form_of_a_path_shows_its_size_in_metres():
    assert "4.000 m, x 0.00 to 1.00, y 0.00 to 1.00 m" in repr(tracking.square(1.0))
    assert "0.00 to 8.00 s" in repr(tracking.square(1.0).with_times(0.5))


def test_all_points_of_a_circle_lie_on_it_and_the_last_is_the_first():
    path = tracking.circle(2.0, points=12, centre=(1.0, -1.0), start_angle=np.pi / 2)
    np.testing.assert_allclose(np.hypot(*(path.points - [1.0, -1.0]).T), 2.0, rtol=1e-14)
    np.testing.assert_allclose(path.points[0], [1.0, 1.0], atol=1e-14)
    assert (path.points[0] == path.points[-1]).all()


def test_a_circle_of_many_points_is_as_long_as_its_circumference():
    assert tracking.circle(points=2000).length == pytest.approx(2 * np.pi * 1.5, rel=1e-5)
    assert tracking.circle(points=60).length == pytest.approx(60 * 3.0 * np.sin(np.pi / 60))


def test_circle_and_square_run_anticlockwise():
    for path in (tracking.circle(), tracking.square()):
        x, y = path.points.T
        assert np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) > 0


def test_a_square_has_its_corners_and_even_way_points_between_them():
    path = tracking.square(2.0, spacing=0.3, corner=(1.0, 1.0))
    gaps = np.hypot(*np.diff(path.points, axis=0).T)
    np.testing.assert_allclose(gaps, 2.0 / 7, rtol=1e-12)
    corners = tracking.square(2.0, spacing=None, corner=(1.0, 1.0)).points
    assert corners.tolist() == [[1, 1], [3, 1], [3, 3], [1, 3], [1, 1]]
    assert all((path.points == corner).all(axis=1).any() for corner in corners)
    assert path.length == pytest.approx(8.0)


def test_the_figure_of_eight_passes_its_centre_again_and_is_curved_by_its_radius_at_the_end():
    path = tracking.figure_eight(1.5, points=4000)
    assert path.points[0].tolist() == path.points[-1].tolist() == [0.0, 0.0]
    np.testing.assert_allclose(path.points[2000], 0.0, atol=1e-12)
    tip = path.points[999:1002]
    a, b = np.diff(tip, axis=0)
    turn = np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b)
    assert np.hypot(*a) / turn == pytest.approx(-1.5, rel=1e-4)
    assert np.ptp(path.points[:, 0]) == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: tracking.circle(-1.0), "radius must be one number above 0"),
        (lambda: tracking.circle(points=2), "points must be one whole number at least 3"),
        (lambda: tracking.circle(points=9.5), "points must be one whole number"),
        (lambda: tracking.circle(centre=(0, 0, 0)), r"centre must have shape \(2,\)"),
        (lambda: tracking.circle(start_angle=np.inf), "start_angle must be one finite number"),
        (lambda: tracking.square(0), "side must be one number above 0"),
        (lambda: tracking.square(spacing=0.0), "spacing must be one number above 0"),
        (lambda: tracking.figure_eight(np.nan), "radius must be one number above 0"),
        (lambda: tracking.from_points([[0, 0]]), "points needs 2 points or more"),
        (lambda: tracking.circle().with_times(0.0), "speed must be one number above 0"),
        (lambda: tracking.circle().with_times("fast"), "speed must be one number above 0"),
        (lambda: tracking.circle().position(1.0), "no times: use path.with_times"),
        (lambda: tracking.circle().with_times(1).position(np.nan), "t must be finite"),
    ],
)
def test_geometries_name_what_is_wrong(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_times_at_one_speed_are_way_over_speed():
    path = tracking.from_points([[0, 0], [3, 0], [3, 4]]).with_times(0.5)
    assert path.times.tolist() == [0.0, 6.0, 14.0]
    assert path.end_time == 14.0


def test_a_point_twice_has_no_times_at_one_speed():
    with pytest.raises(ValueError, match="points 1 and 2 are the same"):
        tracking.from_points([[0, 0], [1, 0], [1, 0], [2, 0]]).with_times(1.0)


@given(st.floats(0.0, 20.0), st.floats(0.05, 2.0))
def test_at_one_speed_the_way_driven_is_speed_times_time(t, speed):
    path = tracking.square(2.0, spacing=None).with_times(speed)
    s = min(speed * t, 8.0)
    side, rest = divmod(s, 2.0)
    corners = np.vstack([path.points, path.points[-1]])
    expected = corners[int(side)] + rest / 2 * (corners[int(side) + 1] - corners[int(side)])
    np.testing.assert_allclose(path.position(t), expected, atol=1e-9)


def test_the_interpolated_goal_is_held_before_the_start_and_after_the_end():
    path = Path([[0, 0], [2, 0]], [1.0, 3.0])
    np.testing.assert_array_equal(
        path.position([[0.0, 1.0], [2.0, 9.0]]), [[[0, 0], [0, 0]], [[1, 0], [2, 0]]]
    )
    assert path.speed_at([0.5, 1.0, 2.9, 3.0]).tolist() == [0.0, 1.0, 1.0, 0.0]


@given(st.floats(0.03, 3.0))
def test_resampling_keeps_the_points_and_the_length(spacing):
    path = tracking.from_points([[0, 0], [1, 0], [1, 0], [0.3, 2.0], [5.0, 2.0]])
    finer = path.resample(spacing)
    assert finer.length == pytest.approx(path.length)
    assert np.hypot(*np.diff(finer.points, axis=0).T).max() <= spacing * (1 + 1e-9)
    assert all((finer.points == point).all(axis=1).any() for point in path.points)


def test_resampling_a_trajectory_keeps_where_it_is_at_each_time():
    path = Path([[0, 0], [1, 0], [1, 3]], [0.0, 4.0, 5.0])
    t = np.linspace(0, 5, 41)
    np.testing.assert_allclose(path.resample(0.21).position(t), path.position(t), atol=1e-12)


def test_a_trajectory_that_waits_cannot_be_resampled():
    with pytest.raises(ValueError, match="stops and waits"):
        Path([[0, 0], [1, 0], [1, 0], [2, 0]], [0, 1, 2, 3]).resample(0.1)


@pytest.mark.parametrize("times", [False, True])
def test_a_written_path_is_read_back_to_the_last_digit(tmp_path, times):
    path = tracking.circle(np.pi / 3, centre=(1e5, -1e-7))
    path = path.with_times(1 / 3) if times else path
    path.write(tmp_path / "circle.csv")
    again = Path.read(tmp_path / "circle.csv")
    np.testing.assert_array_equal(again.points, path.points)
    if times:
        np.testing.assert_array_equal(again.times, path.times)
    else:
        assert again.times is None


def _file(tmp_path, text):
    file = tmp_path / "way.csv"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return file


@pytest.mark.parametrize(
    "text",
    [
        "x,y\n0,0\n1,2.5\n",
        "\ufeffx,y\r\n0,0\r\n1,2.5\r\n",
        " x , y \n 0 , 0 \n +1e0 , .25E1 \n\n\n",
        '"x","y"\n"0","0"\n"1","2.5"',
    ],
)
def test_harmless_ways_to_write_a_file_are_read(tmp_path, text):
    assert Path.read(_file(tmp_path, text)).points.tolist() == [[0.0, 0.0], [1.0, 2.5]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty: the first line must be x,y"),
        ("\n\n", "is empty"),
        ("x,y\n", "has 0 way-points: a path needs 2"),
        ("x,y\n1,2\n", "has 1 way-points: a path needs 2"),
        ("0,0\n1,1\n", "line 1: the header must be x,y or x,y,t .*got the numbers '0,0': add"),
        ("x,z\n0,0\n1,1\n", "line 1: .*got 'z' for 'y' in column 2"),
        ("y,x\n0,0\n1,1\n", "got 'y' for 'x' in column 1"),
        ("x,y,time\n0,0,0\n1,1,1\n", "got 'time' for 't' in column 3"),
        ("x\n0\n1\n", "got 1 columns: 'x'"),
        ("x,y,t,v\n0,0,0,0\n1,1,1,1\n", "got 4 columns"),
        ("x;y\n0;0\n1;1\n", "commas between the columns and a point as the decimal mark"),
        ("x\ty\n0\t0\n1\t1\n", "commas between the columns"),
        ("x,y\n0,0\n1,a\n", "line 3, column y: 'a' is not a finite number"),
        ("x,y\n0,0\nnan,1\n", "line 3, column x: 'nan' is not"),
        ("x,y\n0,0\n1,-inf\n", "line 3, column y: '-inf' is not"),
        ("x,y\n0,0\n1,1e999\n", "line 3, column y: '1e999' is not a finite"),
        ("x,y\n0,0\n1,1_0\n", "column y: '1_0' is not"),
        ("x,y\n0,0\n1,\n", "line 3, column y is empty: expected a number"),
        ("x,y\n0,0\n,\n", "line 3, column x is empty"),
        ("x,y\n0,0\n\n1,1\n", "line 3 is empty"),
        ("x,y\n0,0\n1\n", "line 3: expected 2 cells .x,y., got 1: '1'"),
        ("x,y\n0,0\n1,1,1\n", "line 3: expected 2 cells .x,y., got 3"),
        ("x,y,t\n0,0,0\n1,1\n", "line 3: expected 3 cells .x,y,t., got 2"),
        ("x,y\n0,0,0,0\n1,5,2,5\n", "line 2: expected 2 cells.*a point as the decimal mark"),
        ("x,y\n0;0\n1;1\n", "line 2: expected 2 cells.*use commas"),
        ('x,y\n0,0\n"1,5",2\n', "line 3, column x: '1,5' is not .*write 1.5, not 1,5"),
        ("x,y,t\n0,0,0\n1,1,2\n2,2,2\n", "line 4, column t: 2.0 s does not come after 2.0 s"),
        ("x,y,t\n0,0,5\n1,1,3\n", "line 3, column t: 3.0 s does not come after 5.0 s"),
        ("x,y,t\n0,0,-1\n1,1,3\n", "line 2, column t: -1.0 s is negative"),
        ("x,y\n2,2\n2,2\n", "must go somewhere"),
        (b"x,y\n0,0\n\xff,1\n", "not a CSV text file"),
        (b"x,y\n0,0\n1\x00,1\n", "line 3"),
    ],
)
def test_a_malformed_file_is_refused_with_line_and_column(tmp_path, text, message):
    with pytest.raises(ValueError, match=message):
        Path.read(_file(tmp_path, text))


def test_the_name_of_a_bad_file_is_in_the_message(tmp_path):
    with pytest.raises(ValueError, match=r"way\.csv"):
        Path.read(_file(tmp_path, "x,y\n0,0\n1,a\n"))
    with pytest.raises(FileNotFoundError, match=r"none\.csv"):
        Path.read(tmp_path / "none.csv")


def test_lines_are_numbered_as_an_editor_does_after_a_cell_with_a_line_break(tmp_path):
    with pytest.raises(ValueError, match="line 4, column y"):
        Path.read(_file(tmp_path, 'x,y\n"0\n",0\n1,b\n'))
