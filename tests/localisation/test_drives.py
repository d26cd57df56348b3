"""The scenarios: their truth, their noise, their files, and the drive of the machine itself."""

import numpy as np
import pytest

from backhoe.lessons import published
from backhoe.localisation import drive_log, drives
from backhoe.localisation.drives import NOISE, Noise, files
from backhoe.machine import BACKHOE, replace
from backhoe.mission.recorded import drive_the_machine
from backhoe.mission.write_drives import main

R, L = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("drives")
    assert main(["--folder", str(folder)]) == 0
    return folder


# The truth


@pytest.mark.parametrize(
    "name, table", [("rectangle", "mastalli_2013_table_41"), ("g", "mastalli_2013_table_42")]
)
def test_the_first_two_scenarios_last_as_long_as_the_sources(name, table):
    assert drives.SCENARIOS[name].duration == published.load(table)["duration"]
    motion = drives.truth(name)
    assert motion.time[-1] == pytest.approx(drives.SCENARIOS[name].duration)
    assert len(motion.time) == round(drives.SAMPLE_RATE * motion.time[-1]) + 1


def test_the_third_scenario_is_the_longest_way_and_time():
    way = {name: drives.truth(name).v.sum() for name in drives.SCENARIOS}
    assert max(way, key=way.get) == "circle"
    assert drives.SCENARIOS["circle"].duration > drives.SCENARIOS["g"].duration


def test_the_truth_solves_the_unicycles_equations():
    from scipy.integrate import solve_ivp
    from scipy.interpolate import CubicSpline

    fine = drives.truth("rectangle", 1000.0)
    v, omega = CubicSpline(fine.time, fine.v), CubicSpline(fine.time, fine.omega)

    def rate(t, pose):
        return [v(t) * np.cos(pose[2]), v(t) * np.sin(pose[2]), omega(t)]

    done = solve_ivp(
        rate, (0, 67), np.zeros(3), method="DOP853", rtol=1e-10, atol=1e-10, max_step=0.05
    )
    np.testing.assert_allclose(fine.pose[-1], done.y[:, -1], atol=1e-6)


def test_the_quasi_rectangle_closes_after_one_turn():
    pose = drives.truth("rectangle").pose
    np.testing.assert_allclose(pose[-1], [0, 0, 2 * np.pi], atol=1e-6)
    assert np.ptp(pose[:, 0]) > 8 and np.ptp(pose[:, 1]) > 7


def test_the_g_turns_by_a_full_turn_and_ends_in_a_curve():
    motion = drives.truth("g")
    assert motion.pose[motion.time == 90.0, 2] == pytest.approx(2 * np.pi, abs=1e-3)
    assert np.abs(motion.omega[(motion.time > 91.5) & (motion.time < 97.5)]).min() > 0.19


def test_the_oscillating_straight_is_parallel_to_no_axis():
    motion = drives.truth("circle")
    straight = (motion.time > 105) & (motion.time < 165)
    heading = motion.pose[straight, 2] - 2 * np.pi
    assert np.degrees(heading.mean()) == pytest.approx(63, abs=5)
    assert np.degrees(np.ptp(heading)) > 30


def test_the_accelerometer_feels_the_change_of_the_velocity():
    motion = drives.truth("rectangle", 1000.0)
    heading = motion.pose[:, 2]
    world = np.gradient(motion.pose[:, :2], 1e-3, axis=0)
    world = np.gradient(world, 1e-3, axis=0)
    ahead = world[:, 0] * np.cos(heading) + world[:, 1] * np.sin(heading)
    left = -world[:, 0] * np.sin(heading) + world[:, 1] * np.cos(heading)
    inner = slice(5, -5)
    np.testing.assert_allclose(motion.acceleration[inner, 0], ahead[inner], atol=5e-3)
    np.testing.assert_allclose(motion.acceleration[inner, 1], left[inner], atol=5e-3)


@pytest.mark.parametrize("rate", [0.0, 1e-320, 30.0, 3000.0, np.nan, True, "fast"])
def test_a_rate_that_does_not_divide_1000_hz_is_refused(rate):
    with pytest.raises(ValueError, match=r"rate must (be one number at least 1|divide 1000 Hz)"):
        drives.truth("g", rate)


def test_an_unknown_scenario_is_named_with_those_that_exist():
    with pytest.raises(ValueError, match="name must be one of rectangle, g, circle, got 'square'"):
        drives.record("square")


# The sensors


def test_the_noise_has_the_variances_that_it_says():
    recording, motion = drives.record("circle", runs=4), drives.truth("circle")
    tracks = (motion.v - L / 2 * motion.omega) / R, (motion.v + L / 2 * motion.omega) / R
    parts = [
        (recording.left - tracks[0], NOISE.encoder),
        (recording.right - tracks[1], NOISE.encoder),
        (recording.gyro - motion.omega - recording.bias[:, None], NOISE.gyro),
        (recording.yaw - motion.pose[:, 2], NOISE.yaw),
        (recording.force[..., 2] - BACKHOE.gravity, NOISE.accelerometer),
    ]
    for noise, variance in parts:
        assert noise.var() == pytest.approx(variance, rel=0.02)
        assert abs(noise.mean()) < 4 * np.sqrt(variance / noise.size)
        beside = np.corrcoef(noise[:, 1:].ravel(), noise[:, :-1].ravel())[0, 1]
        assert abs(beside) < 4 / np.sqrt(noise.size)


def test_slip_makes_the_tracks_run_faster_against_each_other_and_changes_nothing_else():
    plain, slipping = drives.record("g"), drives.record("g", turning=drives.SLIPPING)
    apart = [(run.right - run.left) for run in (plain, slipping)]
    extra = L * drives.truth("g").omega * (1 / drives.SLIPPING - 1) / R
    np.testing.assert_allclose(apart[1] - apart[0], extra, atol=1e-12)
    np.testing.assert_allclose(slipping.right + slipping.left, plain.right + plain.left)
    for sensor in ("gyro", "yaw", "truth", "force"):
        np.testing.assert_array_equal(getattr(slipping, sensor), getattr(plain, sensor))


def test_another_machine_has_other_encoders():
    wide = replace(BACKHOE, tracks=replace(BACKHOE.tracks, gauge=2 * L))
    plain, wider = drives.record("g"), drives.record("g", machine=wide)
    extra = L * drives.truth("g").omega / R
    np.testing.assert_allclose((wider.right - wider.left) - (plain.right - plain.left), extra)


def test_runs_have_noise_of_their_own_and_a_seed_repeats_them():
    first, again = (drives.record("rectangle", runs=3, seed=5) for _ in range(2))
    np.testing.assert_array_equal(first.left, again.left)
    assert (first.left[0] != first.left[1]).all()
    assert len(set(first.bias)) == 3
    assert (drives.record("rectangle", runs=3, seed=6).gyro != first.gyro).all()


def test_the_truth_is_interpolated_and_not_beyond_its_ends():
    recording = drives.record("rectangle")
    middle = recording.truth_at(10.005)
    np.testing.assert_allclose(middle, (recording.truth[1000] + recording.truth[1001]) / 2)
    with pytest.raises(ValueError, match="from 0 to 67 s"):
        recording.truth_at([1.0, 68.0])


@pytest.mark.parametrize(
    "options, message",
    [
        ({"turning": 0.0}, "turning must be one number above 0"),
        ({"turning": 1.2}, "at most 1"),
        ({"runs": 0}, "runs must be one whole number"),
        ({"runs": 2.5}, "runs must be one whole number"),
        ({"seed": -1}, "seed must be one whole number"),
        ({"rate": 33.0}, "must divide"),
    ],
)
def test_numbers_out_of_range_are_refused(options, message):
    with pytest.raises(ValueError, match=message):
        drives.record("g", **options)


def test_a_negative_variance_is_refused():
    with pytest.raises(ValueError, match=r"Noise\.gyro must be one number at least 0"):
        Noise(0.02, -1.0, 0.02, 0.02, 0.0)


# The files


def test_the_files_are_what_the_command_writes(made):
    written = sorted(path.name for path in made.iterdir())
    kept = sorted(path.name for path in drives.FOLDER.glob("*.csv"))
    assert written == kept
    for name in written:
        new, old = ((folder / name).read_text().splitlines() for folder in (made, drives.FOLDER))
        comments = [line for line in old if line.startswith("#")]
        assert [line for line in new if line.startswith("#")] == comments
        head = len(comments)
        assert new[head] == old[head] and len(new) == len(old)
        table = [np.loadtxt(lines[head + 1 :], delimiter=",") for lines in (new, old)]
        digit = 1e-4 if "truth" in name else 1e-3
        np.testing.assert_allclose(*table, rtol=0, atol=1.01 * digit)


@pytest.mark.parametrize("name", drives.names())
def test_each_file_says_what_it_is_and_how_it_was_made(name):
    kinds = ("encoders", "imu", "truth")
    for kind, path in zip(kinds, files._paths(name, drives.FOLDER), strict=True):
        lines = path.read_text().splitlines()
        assert lines[0].startswith(f"# {kind} of: ")
        assert lines[1] == "# made by: python -m backhoe.mission.write_drives"
        assert path.stat().st_size < 400_000
        if kind != "truth":
            assert any("seed 2013" in line and "0.02" in line for line in lines[:5])


def test_a_loaded_drive_is_the_recorded_one_rounded():
    loaded, made_here = drives.load("g_slip"), drives.record("g", turning=drives.SLIPPING)
    for sensor in ("time", "left", "right", "gyro", "yaw"):
        np.testing.assert_allclose(
            getattr(loaded, sensor), getattr(made_here, sensor), atol=0.51e-3
        )
    np.testing.assert_allclose(loaded.truth, made_here.truth_at(loaded.truth_time), atol=0.51e-4)
    assert np.isnan(loaded.turning) and np.isnan(loaded.bias)


def test_the_files_read_as_logs_with_units():
    log = drive_log.read(drives.FOLDER / "rectangle_encoders.csv", require=("left_rate",))
    assert log.units["left_rate"] == "rad/s"
    assert any("seed" in comment for comment in log.comments)


def test_a_students_log_of_angles_becomes_rates(tmp_path):
    time = np.arange(200) * 0.02
    columns = {"t [s]": time, "left [rad]": 2 * time, "right [rad]": 3 * time}
    drive_log.write(tmp_path / "mine.csv", columns)
    recording = drives.from_log(drive_log.read(tmp_path / "mine.csv"))
    np.testing.assert_allclose(recording.left, 2.0)
    np.testing.assert_allclose(recording.right, 3.0)
    assert np.isnan(recording.gyro).all()
    np.testing.assert_array_equal(recording.truth, np.zeros((1, 3)))


def test_a_log_without_encoders_and_an_imu_of_other_times_are_refused():
    folder = drives.FOLDER
    imu = drive_log.read(folder / "g_imu.csv", require=("gyro",))
    with pytest.raises(ValueError, match="must have left_rate and right_rate"):
        drives.from_log(imu)
    encoders = drive_log.read(folder / "rectangle_encoders.csv", require=("left_rate",))
    with pytest.raises(ValueError, match="must have the same times"):
        drives.from_log(encoders, imu)


def test_a_missing_drive_or_file_is_named(tmp_path):
    with pytest.raises(ValueError, match="name must be one of backhoe, circle, circle_slip"):
        drives.load("h")
    with pytest.raises(
        FileNotFoundError, match=r"g_encoders.*python -m backhoe\.mission\.write_drives"
    ):
        drives.load("g", tmp_path)


# The machine itself


def test_the_machines_drive_starts_at_rest_and_ends_at_the_end_of_the_g():
    from backhoe.mission import default_route

    recording = drives.load("backhoe")
    assert np.abs(recording.truth_at(2.9)).max() < 0.01
    assert np.hypot(*(recording.truth[-1, :2] - default_route().points[-1])) < 0.1


def test_the_simulated_tracks_slip_when_the_machine_turns():
    recording = drives.load("backhoe")
    unslipped = R / L * np.sum(np.diff(recording.time) * (recording.right - recording.left)[1:])
    turned = recording.truth[-1, 2] - recording.truth[0, 2]
    assert turned / unslipped == pytest.approx(drives.SLIPPING, abs=0.03)


def test_a_short_drive_of_the_machine_has_noise_as_asked_for():
    from backhoe.vehicle.tracking import from_points

    path = from_points([(0.0, 0.0), (1.0, 0.0)], 0.1).with_times(0.5)
    silent = drive_the_machine(path, noise=Noise(0, 0, 0, 0, 0), time_limit=1.0)
    noisy = drive_the_machine(path, time_limit=1.0)
    np.testing.assert_array_equal(silent.truth, noisy.truth)
    np.testing.assert_allclose(silent.yaw, silent.truth[:, 2])
    assert (noisy.left - silent.left).std() == pytest.approx(np.sqrt(NOISE.encoder), rel=0.2)
