"""Logs of drives: what is written comes back, and what is wrong is named."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from backhoe.localisation import drive_log, odometry
from backhoe.localisation.odometry import Encoder

RATE = 50


def drive(seconds=12.0, rate=RATE):
    """Columns of a drive at 0.5 m/s with turns to both sides, by label."""
    t = np.arange(round(seconds * rate) + 1) / rate
    omega = 0.4 * np.sin(0.8 * t)
    v = np.full_like(t, 0.5)
    pose = odometry.from_samples([2.0, 1.0, 0.3], t, v, omega)
    u = odometry.tracks().wheel_speeds(np.stack([v, 0 * v, omega], axis=-1))
    left, right = odometry.bilinear_sum(t, u.T)
    labels = ["t [s]", "left [rad]", "right [rad]", "gyro [rad/s]", "x [m]", "y [m]", "psi [rad]"]
    return dict(zip(labels, [t, left, right, omega, *pose.T], strict=True))


def saved(tmp_path, columns, **arguments):
    file = tmp_path / "drive.csv"
    drive_log.write(file, columns, **arguments)
    return file


def lines_of(tmp_path):
    return saved(tmp_path, drive()).read_text().splitlines()


def read_lines(tmp_path, lines, **arguments):
    file = tmp_path / "spoilt.csv"
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return drive_log.read(file, **arguments)


def test_a_log_comes_back_to_the_last_digit(tmp_path):
    columns = drive()
    log = drive_log.read(saved(tmp_path, columns, comments=["seed 4", "python -m x, y"]))
    np.testing.assert_array_equal(log.time, columns["t [s]"])
    for label, values in columns.items():
        if label != "t [s]":
            np.testing.assert_array_equal(log[label.split()[0]], values)
    assert log.comments == ("seed 4", "python -m x, y") and log.converted == ()
    assert dict(log.units)["gyro"] == "rad/s" and len(log) == 601
    assert "DriveLog(601 rows, 12.00 s, left [rad], right [rad]" in repr(log)


def test_writing_what_was_read_gives_the_same_file(tmp_path):
    file = saved(tmp_path, drive(), comments=["seed 4"], digits=7)
    again = tmp_path / "again.csv"
    drive_log.write(again, drive_log.read(file), digits=7)
    assert again.read_bytes() == file.read_bytes()


@settings(max_examples=30, deadline=None)
@given(st.lists(st.floats(-1e6, 1e6), min_size=3, max_size=20))
def test_any_finite_number_survives_the_file(tmp_path_factory, values):
    file = tmp_path_factory.mktemp("logs") / "drive.csv"
    drive_log.write(file, {"t [s]": np.arange(len(values)), "temperature [1]": values})
    np.testing.assert_array_equal(drive_log.read(file, require=())["temperature"], values)


def test_a_log_serves_odometry(tmp_path):
    log = drive_log.read(saved(tmp_path, drive()))
    poses = odometry.from_angles(log.pose[0], *log.angles())
    np.testing.assert_allclose(poses[-1], log.pose[-1], atol=1e-3)
    assert log.period == pytest.approx(1 / RATE) and log.duration == pytest.approx(12.0)


def test_ticks_that_overflow_become_angles(tmp_path):
    columns, encoder = drive(), Encoder(4096, bits=12)
    for side in ("left", "right"):
        columns[f"{side} [ticks]"] = encoder.count(columns.pop(f"{side} [rad]") + 3.0)
    file = saved(tmp_path, columns)
    assert ".0," not in file.read_text().splitlines()[1].split(",", 5)[-1]
    log = drive_log.read(file)
    assert (np.abs(np.diff(log["left"])) > 4000).any()
    for found, side in zip(log.angles(encoder), ("left", "right"), strict=True):
        np.testing.assert_allclose(found, drive()[f"{side} [rad]"], atol=encoder.resolution)
    with pytest.raises(ValueError, match=r"left is in ticks: .*Encoder\(ticks="):
        log.angles()


def test_units_that_the_header_names_are_converted_and_told(tmp_path):
    columns = drive()
    lines = lines_of(tmp_path)
    lines[0] = "t [ms],left [deg],right [deg],gyro [deg/s],x [mm],y [cm],psi [deg]"
    factors = [1e3, *[180 / np.pi] * 3, 1e3, 1e2, 180 / np.pi]
    table = np.stack(list(columns.values()), axis=-1) * factors
    lines[1:] = [",".join(map(repr, row)) for row in table.tolist()]
    log = read_lines(tmp_path, lines)
    np.testing.assert_allclose(log.time, columns["t [s]"], rtol=1e-14)
    np.testing.assert_allclose(log.pose[:, 1], columns["y [m]"], rtol=1e-14)
    np.testing.assert_allclose(log["gyro"], columns["gyro [rad/s]"], rtol=1e-14)
    assert log.converted[:2] == ("t from ms", "left from deg") and log.units["x"] == "m"


def test_columns_of_a_log_cannot_be_changed_or_confused(tmp_path):
    log = drive_log.read(saved(tmp_path, drive()))
    with pytest.raises(ValueError, match="read-only"):
        log["left"][0] = 1.0
    with pytest.raises(KeyError, match="no column 'yaw'; it has left, right, gyro"):
        log["yaw"]
    assert "gyro" in log and "yaw" not in log and "t" not in log


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("t [s],left [rad],gyro [rad/s]", r"line 1: column 'right' is missing; there are t \[s\]"),
        ("time [s],left [rad],right [rad]", "line 1: column 't' is missing"),
        ("t,left,right", r"line 1, column 1: 't' must be a name with its unit, such as"),
        ("t [s],left [rad],right [furlong]", r"column 3: the unit of 'right \[furlong\]' is not"),
        ("t [s],left [m],right [rad]", r"'left' is measured in rad or ticks, got 'left \[m\]'"),
        ("t [s],left [rad],left [rad],right [rad]", "column 'left' is there 2 times"),
        ("t [s],left [rad],right [rad],a [1],a [1]", "column 'a' is there 2 times"),
        ("0.0,0.1,0.2", "line 1: the header is missing, there are numbers"),
        ("t [s];left [rad];right [rad]", "no commas between its columns"),
        ("t [s],left [rad],right [rad],", "column 4: '' must be a name with its unit"),
    ],
)
def test_a_bad_header_is_named(tmp_path, header, message):
    with pytest.raises(ValueError, match=rf"spoilt.csv, .*{message}"):
        read_lines(tmp_path, [header, "0,0,0", "1,0,0", "2,0,0", "3,0,0"])


@pytest.mark.parametrize(
    ("cell", "message"),
    [
        ("", "is empty: a log needs every value; interpolate it or take the row out"),
        ("nan", "'nan' is no value; interpolate it or take the row out"),
        ("NaN", "'NaN' is no value"),
        ("inf", "'inf' is not a finite number"),
        ("1e999", "'1e999' is not a finite number"),
        ("abc", "'abc' is not a finite number"),
        ("1_000", "'1_000' is not a finite number"),
        ("0x10", "'0x10' is not a finite number"),
        ("1.5 rad", "'1.5 rad' is not a finite number"),
    ],
)
def test_a_bad_cell_is_named_by_line_and_column(tmp_path, cell, message):
    lines = ["# made by hand", *lines_of(tmp_path)]
    cells = lines[41].split(",")
    cells[3] = cell
    lines[41] = ",".join(cells)
    with pytest.raises(
        ValueError, match=rf"spoilt.csv, line 42, column gyro \[rad/s\]:? ?{message}"
    ):
        read_lines(tmp_path, lines)


def spoil_row(change):
    def spoil(lines):
        lines[40] = change(lines[40])
        return lines

    return spoil


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (spoil_row(lambda row: row + ",1"), "line 41: expected 7 cells, got 8"),
        (
            spoil_row(lambda row: row.rsplit(",", 1)[0]),
            r"line 41: expected 7 cells, got 6: .*is the file cut off, or psi \[rad\] missing",
        ),
        (
            spoil_row(lambda row: row.replace(",", ";").replace(".", ",")),
            r"line 41: .*use commas between the columns and a point",
        ),
        (spoil_row(lambda row: ""), "line 41 is empty: take it out"),
        (lambda lines: lines[:3], "has 2 rows below its header: a log needs 3 or more"),
        (lambda lines: [], "is empty: it needs a header"),
        (lambda lines: ["# only this"], "is empty: it needs a header"),
        (
            lambda lines: [*lines[:40], lines[41], lines[40], *lines[42:]],
            r"line 42, column t \[s\]: 0.78 s does not come after 0.8 s",
        ),
        (
            lambda lines: [*lines[:40], lines[40], *lines[40:]],
            r"line 42, column t \[s\]: 0.78 s does not come after 0.78 s",
        ),
        (
            lambda lines: [*lines[:40], *lines[60:]],
            r"line 41, column t \[s\]: a gap of 0.42 s after 0.76 s, 21 periods of 0.02 s",
        ),
    ],
)
def test_bad_rows_and_times_are_named(tmp_path, spoil, message):
    with pytest.raises(ValueError, match=rf"spoilt.csv.*{message}"):
        read_lines(tmp_path, spoil(lines_of(tmp_path)))


def test_a_gap_can_be_allowed_and_nothing_is_filled_in(tmp_path):
    lines = lines_of(tmp_path)
    log = read_lines(tmp_path, [*lines[:40], *lines[60:]], max_gap=30)
    assert len(log) == 581 and np.diff(log.time).max() == pytest.approx(0.42)
    with pytest.raises(
        ValueError, match=r"max_gap must be one number at least 1 \[periods\], got 0"
    ):
        read_lines(tmp_path, lines, max_gap=0)


def test_what_is_no_text_is_no_log(tmp_path):
    file = tmp_path / "drive.csv"
    file.write_bytes(b"\xff\xfe\x00t [s]")
    with pytest.raises(ValueError, match=r"drive.csv is not a CSV text file"):
        drive_log.read(file)
    with pytest.raises(FileNotFoundError):
        drive_log.read(tmp_path / "none.csv")


@pytest.mark.parametrize(
    ("label", "factor", "message"),
    [
        ("t [s]", 1e3, r"line 3, column t \[s\]: a period of 20 s: are the times in milliseconds"),
        ("x [m]", 1e3, r"column x \[m\]: changes by .* above 30: is it in millimetres"),
        ("gyro [rad/s]", 57.3, r"column gyro \[rad/s\]: is .* above 10: is it in degrees per sec"),
        ("psi [rad]", 57.3, r"column psi \[rad\]: changes by .* above 10: is it in degrees"),
        ("left [rad]", 57.3, r"column left \[rad\]: changes by .* above 60: is it in degrees"),
    ],
)
def test_a_unit_that_the_magnitude_contradicts_is_named(tmp_path, label, factor, message):
    columns = drive()
    columns[label] = columns[label] * factor
    with pytest.raises(ValueError, match=rf"drive.csv, {message}|drive.csv, line \d+, {message}"):
        drive_log.read(saved(tmp_path, columns))


def slow(seconds=60.0):
    """A drive so slow that no magnitude betrays an angle's unit: 0.16 m/s and 0.04 rad/s."""
    t = np.arange(round(seconds * 20) + 1) / 20
    omega, v = 0.04 * np.cos(0.05 * t), np.full_like(t, 0.16)
    pose = odometry.from_samples(np.zeros(3), t, v, omega)
    u = odometry.tracks().wheel_speeds(np.stack([v, 0 * v, omega], axis=-1))
    left, right = odometry.bilinear_sum(t, u.T)
    labels = ["t [s]", "left [rad]", "right [rad]", "gyro [rad/s]", "x [m]", "y [m]", "psi [rad]"]
    return dict(zip(labels, [t, left, right, omega, *pose.T], strict=True))


@pytest.mark.parametrize(
    ("factors", "message"),
    [
        ({"psi [rad]": 57.3}, "column psi: turns 57.3 times as far as gyro says"),
        ({"gyro [rad/s]": 57.3}, "column gyro: turns 57.3 times as far as psi says"),
        (
            {"psi [rad]": 57.3, "gyro [rad/s]": 57.3},
            "columns psi, left, right: a turn of .* is psi in degrees",
        ),
        ({"x [m]": 100, "y [m]": 100}, r"columns x, y, left, right: .* are x, y in centimetres"),
        ({"x [m]": 1e3, "y [m]": 1e3}, r"line \d+, column x \[m\]: .* is it in millimetres"),
        (
            {"left [rad]": 57.3, "right [rad]": 57.3},
            r"columns (psi|x, y), left, right: .*left, right in degrees",
        ),
    ],
)
def test_units_are_contradicted_by_other_columns_when_the_drive_is_slow(tmp_path, factors, message):
    columns = slow()
    assert len(drive_log.read(saved(tmp_path, columns))) == 1201
    for label, factor in factors.items():
        columns[label] = columns[label] * factor
    with pytest.raises(ValueError, match=rf"drive.csv, {message}"):
        drive_log.read(saved(tmp_path, columns))


def test_acceleration_in_g_is_noticed(tmp_path):
    columns = drive()
    columns |= {"ax [m/s^2]": 0.02 * np.sin(columns["t [s]"]), "ay [m/s^2]": columns["t [s]"] * 0}
    columns["az [m/s^2]"] = np.full(601, 1.0)
    with pytest.raises(ValueError, match=r"columns ax, ay, az: their size is 1 .*are they in g"):
        drive_log.read(saved(tmp_path, columns))
    columns["az [m/s^2]"] = np.full(601, 9.8)
    assert drive_log.read(saved(tmp_path, columns))["az"][0] == 9.8


def test_noise_of_a_position_is_no_speed(tmp_path):
    columns, rng = drive(), np.random.default_rng(1)
    for label in ("x [m]", "y [m]", "psi [rad]", "gyro [rad/s]"):
        columns[label] = columns[label] + np.sqrt(0.02) * rng.normal(size=601)
    assert len(drive_log.read(saved(tmp_path, columns))) == 601


def test_limits_can_be_moved_or_lifted(tmp_path):
    columns = drive()
    columns["x [m]"], columns["y [m]"] = 1e3 * columns["x [m]"], 1e3 * columns["y [m]"]
    file = saved(tmp_path, columns)
    with pytest.raises(ValueError, match="above 300"):
        drive_log.read(file, limits={"x": 300})
    assert len(drive_log.read(file, limits={"x": None, "y": None})) == 601
    with pytest.raises(
        ValueError, match=r"a column with a limit must be one of t, left, .* got 'speed'"
    ):
        drive_log.read(file, limits={"speed": 1})


def test_a_counter_that_was_reset_is_named(tmp_path):
    columns = drive()
    columns["left [rad]"] = np.where(
        np.arange(601) >= 300,
        columns["left [rad]"] - columns["left [rad]"][300],
        columns["left [rad]"],
    )
    with pytest.raises(
        ValueError, match=r"line 302, column left \[rad\]: falls from .* to 0 rad: was the counter"
    ):
        drive_log.read(saved(tmp_path, columns))


def test_a_tick_counter_that_was_reset_is_no_overflow(tmp_path):
    columns, encoder = drive(), Encoder(4096, bits=16)
    left = encoder.count(columns.pop("left [rad]"))
    columns["left [ticks]"] = np.where(np.arange(601) >= 500, left - left[500], left)
    with pytest.raises(ValueError, match=r"line 502, column left \[ticks\]: falls from \d+ to 0"):
        drive_log.read(saved(tmp_path, columns))


def test_a_lost_reading_is_a_jump(tmp_path):
    columns = drive()
    columns["right [rad]"] = columns["right [rad]"] + 40.0 * (np.arange(601) >= 200)
    with pytest.raises(ValueError, match=r"line 202, column right \[rad\]: jumps from .*a lost"):
        drive_log.read(saved(tmp_path, columns))


def test_a_wrapped_heading_is_named_and_put_together_only_on_request(tmp_path):
    columns = drive()
    psi = columns["psi [rad]"] + 2.7
    columns["psi [rad]"] = (psi + np.pi) % (2 * np.pi) - np.pi
    file = saved(tmp_path, columns)
    with pytest.raises(
        ValueError, match=r"column psi \[rad\]: jumps from .* a whole turn: psi was"
    ):
        drive_log.read(file)
    np.testing.assert_allclose(drive_log.read(file, unwrap=True)["psi"], psi, atol=1e-12)


def test_the_yaw_of_an_imu_may_be_wrapped_and_still_betrays_degrees(tmp_path):
    columns = drive()
    yaw = columns.pop("psi [rad]") + 2.7
    columns["yaw [rad]"] = (yaw + np.pi) % (2 * np.pi) - np.pi
    assert len(drive_log.read(saved(tmp_path, columns))) == 601
    columns["yaw [rad]"] = np.degrees(columns["yaw [rad]"])
    with pytest.raises(ValueError, match=r"column yaw \[rad\]: changes by .* is it in degrees"):
        drive_log.read(saved(tmp_path, columns))
    columns = slow()
    columns["yaw [rad]"] = np.degrees(columns.pop("psi [rad]"))
    with pytest.raises(ValueError, match=r"column yaw: turns 57.3 times as far as gyro says"):
        drive_log.read(saved(tmp_path, columns))


def test_a_machine_that_stands_still_is_no_error(tmp_path):
    columns = {label: 0 * values for label, values in drive().items() if label != "t [s]"}
    log = drive_log.read(saved(tmp_path, {"t [s]": drive()["t [s]"]} | columns))
    assert not log["left"].any()


def test_jumps_of_a_wheel_are_believed_when_its_limit_is_lifted(tmp_path):
    columns = drive()
    columns["right [rad]"] = columns["right [rad]"] + 40.0 * (np.arange(601) >= 200)
    limits = {"right": None, "psi": None, "gyro": None}
    assert len(drive_log.read(saved(tmp_path, columns), limits=limits)) == 601


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"t [s]": [0, 1], "left [rad]": [0]}, "all columns must be of one length, got"),
        ({"left [rad]": [0, 1], "t [s]": [0, 1]}, r"the first column must be 't \[s\]'"),
        ({"t [s]": [0, 1], "psi [deg]": [0, 1]}, "write rad instead of deg"),
        ({"t [s]": [0, 1], "psi": [0, 1]}, "'psi' must be a name with its unit"),
        ({"t [s]": [0, np.nan]}, r"t \[s\] must be finite, got nan at index 1"),
        ({"t [s]": ["a"]}, r"t \[s\] must be numbers"),
    ],
)
def test_what_cannot_be_read_again_is_not_written(tmp_path, columns, message):
    with pytest.raises(ValueError, match=message):
        drive_log.write(tmp_path / "drive.csv", columns)
    assert not (tmp_path / "drive.csv").exists()


def test_comments_are_single_lines_and_digits_whole(tmp_path):
    with pytest.raises(ValueError, match="a comment must be one line"):
        drive_log.write(tmp_path / "a.csv", drive(), comments=["one\ntwo"])
    with pytest.raises(
        ValueError, match="digits must be one whole number at least 1 and at most 17, got 0"
    ):
        drive_log.write(tmp_path / "a.csv", drive(), digits=0)
