"""The localisation filters: model, sampling, consistency, what no sensor shows, and the scores."""

import numpy as np
import pytest

from backhoe.localisation import drives, fusion, kalman, odometry
from backhoe.localisation.drives import NOISE
from backhoe.localisation.fusion import Model
from backhoe.localisation.fusion.model import ANGLES, BIAS, PSI, TURNED, TURNING
from backhoe.localisation.fusion.observability import _range_and_bearing
from backhoe.machine import BACKHOE
from backhoe.vehicle.tracks import tracks_twist

RNG = np.random.default_rng(40)
R, L = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge
SCENARIOS = tuple(drives.SCENARIOS)


def station(recording, rng):
    return fusion.total_station(recording, 10.0, rng)


@pytest.fixture(scope="module")
def trials():
    """Monte Carlo trials, each run once: trial(name, estimator, turning, **options)."""
    kept = {}

    def trial(name, estimator, turning=1.0, **options):
        key = name, estimator, turning, tuple(sorted(options.items()))
        if key not in kept:
            kept[key] = fusion.monte_carlo(name, estimator, turning=turning, **options)
        return kept[key]

    return trial


@pytest.fixture(scope="module")
def drive():
    return drives.record("rectangle", turning=drives.SLIPPING)


# Cycles of 30 Hz from samples of 100 Hz


def test_a_cycle_has_three_three_and_four_samples_in_turn():
    ends = fusion.cycles(np.arange(301) * 0.01)
    assert set(np.diff(ends).tolist()) == {3, 4}
    assert np.diff(ends)[:6].tolist() == [3, 3, 4, 3, 3, 4]
    assert ends[-1] == 300


def test_a_cycle_ends_with_the_newest_sample_and_never_looks_ahead():
    time = np.sort(RNG.uniform(0, 10, 2000))
    time[0] = 0.0
    ends = fusion.cycles(time, 12.0)
    wanted = np.arange(len(ends)) / 12
    assert (time[ends] <= wanted + 1e-9).all()
    following = np.minimum(ends + 1, len(time) - 1)
    assert (time[following][:-1] > wanted[:-1]).all()


def test_the_increments_of_all_samples_add_up_to_the_whole_turn(drive):
    steps = fusion.increments(drive)
    last = fusion.cycles(drive.time)[-1]
    for signal, summed in ((drive.left, steps.left), (drive.gyro, steps.turn)):
        assert summed.sum() == pytest.approx(0.01 * signal[1 : last + 1].sum())
    assert steps.samples.sum() == last
    np.testing.assert_allclose(np.diff(steps.time), steps.dt)


def test_the_latest_sample_alone_has_the_noise_of_one(drive):
    many = drives.record("rectangle", runs=20)
    alike, latest = (fusion.increments(many, use=use) for use in ("all", "latest"))
    spread = [np.var(steps.turn[:, :60] / steps.dt[:60]) for steps in (alike, latest)]
    assert spread[1] == pytest.approx(NOISE.gyro, rel=0.1)
    assert spread[0] == pytest.approx(NOISE.gyro * 0.3, rel=0.15)


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda d: fusion.cycles([0.0, 1.0, 0.5]), "time must rise"),
        (lambda d: fusion.cycles([0.0]), "2 or more"),
        (lambda d: fusion.cycles(d.time, 0.0), "rate must be one number above 0"),
        (lambda d: fusion.cycles(d.time, 400.0), "faster than the samples"),
        (lambda d: fusion.increments(d, use="some"), "use must be one of all, latest"),
    ],
)
def test_cycles_that_cannot_be_are_refused(drive, call, message):
    with pytest.raises(ValueError, match=message):
        call(drive)


# The model


def random_states(count):
    x = RNG.normal(size=(count, 6))
    x[:, TURNING] = RNG.uniform(0.5, 1.0, count)
    return x


def test_the_jacobian_of_the_motion_agrees_with_differences():
    model = Model()
    for x in random_states(20):
        u = RNG.normal(scale=0.3, size=2)
        wanted = kalman.numerical_jacobian(lambda x, u=u: model.f(x, u, 0.03), x)
        np.testing.assert_allclose(model.F(x, u, 0.03), wanted, atol=1e-7)


def test_the_noise_of_the_motion_is_that_of_the_encoders_seen_through_it():
    model, dt = Model(period=0.01), 0.03
    for x in random_states(10):
        u = RNG.normal(scale=0.3, size=2)
        G = kalman.numerical_jacobian(lambda u, x=x: model.f(x, u, dt), u)
        wanted = NOISE.encoder * dt * 0.01 * G @ G.T
        np.testing.assert_allclose(model.Q(x, u, dt), wanted, atol=1e-12)


def test_the_walks_add_to_bias_and_turning_in_proportion_to_time():
    still, walking = Model(), Model(bias_walk=0.1, turning_walk=0.2)
    x, u = random_states(1)[0], np.zeros(2)
    added = walking.Q(x, u, 0.5) - still.Q(x, u, 0.5)
    np.testing.assert_allclose(np.diag(added)[[BIAS, TURNING]], [0.5 * 0.01, 0.5 * 0.04])
    assert np.count_nonzero(np.abs(added) > 1e-15) == 2


def test_the_motion_goes_the_odometrys_way():
    model, u = Model(), np.array([0.02, 0.05])
    state = np.array([1.0, 2.0, 0.3, 0.0, 0.75, 0.0])
    distance, turn = tracks_twist(u[0], u[1], gauge=L / 0.75)
    wanted = odometry.advance(state[:3], float(distance), float(turn))
    np.testing.assert_allclose(model.f(state, u, 0.03)[:3], wanted, atol=1e-7)


def test_the_model_gives_many_runs_what_it_gives_each():
    model, x, u = Model(), random_states(5), RNG.normal(size=(5, 2))
    for function in (model.f, model.F, model.Q):
        each = np.array([function(x[i], u[i], 0.03) for i in range(5)])
        np.testing.assert_allclose(function(x, u, 0.03), each, atol=1e-15)


def test_after_an_update_by_the_gyro_the_turn_is_counted_anew():
    model = Model()
    filter_ = kalman.ExtendedKalmanFilter(
        model.f, model.F, None, None, model.Q, None, random_states(1)[0], np.eye(6), angles=ANGLES
    )
    filter_.predict(np.array([0.1, 0.2]), 0.03)
    before = filter_.P[:TURNED, :TURNED].copy()
    model.restart_turn(filter_)
    assert filter_.x[TURNED] == 0 and not filter_.P[TURNED].any() and not filter_.P[:, TURNED].any()
    np.testing.assert_array_equal(filter_.P[:TURNED, :TURNED], before)


# Dead reckoning


def test_without_noise_and_slip_odometry_is_the_truth():
    silent = drives.Noise(0, 0, 0, 0, 0)
    clean = drives.record("g", noise=silent)
    estimate = fusion.dead_reckoning(clean)
    assert np.abs(estimate.pose - clean.truth).max() < 5e-3
    slipping = drives.record("g", turning=0.75, noise=silent)
    known = fusion.dead_reckoning(slipping, turning=0.75)
    np.testing.assert_allclose(known.pose, estimate.pose, atol=1e-9)


def test_odometry_that_does_not_know_of_the_slip_turns_too_far():
    slipping = drives.record("g", turning=0.75)
    estimate = fusion.dead_reckoning(slipping)
    turned = estimate.pose[-1, 2] / slipping.truth[-1, 2]
    assert turned == pytest.approx(1 / 0.75, rel=0.02)


# The pose filter


@pytest.mark.parametrize("turning", [1.0, drives.SLIPPING])
@pytest.mark.parametrize("name", SCENARIOS)
def test_the_pose_filter_with_yaw_is_consistent_in_every_scenario(trials, name, turning):
    trial = trials(name, fusion.pose_filter, turning, heading="yaw")
    assert trial.band == pytest.approx((2.36, 3.72), abs=0.005)
    assert trial.band[0] < trial.mean_nees < trial.band[1]
    assert trial.inside > 0.7
    assert 0.95 < trial.nis.mean() < 1.05
    assert trial.sigma_xy[-1] == pytest.approx(trial.scatter_xy[-1], rel=0.2)


@pytest.mark.parametrize("turning", [1.0, drives.SLIPPING])
def test_with_the_gyros_rate_it_is_consistent_as_long_as_the_heading_is_known(trials, turning):
    trial = trials("rectangle", fusion.pose_filter, turning)
    assert trial.band[0] < trial.mean_nees < trial.band[1]
    assert 0.9 < trial.nis.mean() < 1.1


def test_over_a_long_way_the_rate_alone_bends_the_errors_and_only_the_position_is_overrated(trials):
    trial = trials("circle", fusion.pose_filter)
    heading = trial.error[..., 2] ** 2 / trial.estimate.covariance[:, 1:, 2, 2]
    assert heading.mean() == pytest.approx(1.0, abs=0.35)
    assert 4 < trial.mean_nees < 10
    mended = trials("circle", fusion.pose_filter, fixes=station)
    assert mended.band[0] < mended.mean_nees < mended.band[1]


def test_the_slip_is_found_whatever_was_thought_before(trials):
    for turning in (1.0, drives.SLIPPING):
        trial = trials("g", fusion.pose_filter, turning, heading="yaw")
        found, claimed = trial.estimate.state[:, -1, TURNING], trial.estimate.std[:, -1, TURNING]
        assert found.mean() == pytest.approx(turning, abs=0.003)
        assert found.std() == pytest.approx(claimed.mean(), rel=0.35)


def test_the_gyros_bias_is_found(trials):
    trial = trials("rectangle", fusion.pose_filter, drives.SLIPPING)
    error = trial.estimate.state[:, -1, BIAS] - trial.recording.bias
    scaled = error / trial.estimate.std[:, -1, BIAS]
    assert np.mean(scaled**2) == pytest.approx(1.0, abs=0.5)


def test_an_update_by_the_gyro_in_each_cycle_mistakes_noise_for_slip(trials):
    each = trials("g", fusion.pose_filter, gyro_period=0.02)
    second = trials("g", fusion.pose_filter)
    assert each.estimate.state[:, -1, TURNING].mean() < 0.98
    assert second.estimate.state[:, -1, TURNING].mean() > 0.99
    assert each.mean_nees > 5 * second.mean_nees


def test_a_filter_that_takes_the_slip_for_known_is_sure_and_wrong(trials):
    trial = trials("g", fusion.pose_filter, drives.SLIPPING, heading="yaw", slip=False)
    assert trial.mean_nees > 100
    assert trial.nis.mean() > trial.nis_band[1]


def test_the_latest_sample_alone_loses_what_the_others_knew(trials):
    whole = trials("rectangle", fusion.pose_filter, drives.SLIPPING)
    latest = trials("rectangle", fusion.pose_filter, drives.SLIPPING, use="latest")
    assert latest.scatter_xy[-1] > 1.4 * whole.scatter_xy[-1]
    assert latest.sigma_xy[-1] > 1.4 * whole.sigma_xy[-1]


def test_without_a_fix_the_position_grows_uncertain_and_with_one_it_does_not(trials):
    free = trials("circle", fusion.pose_filter, heading="yaw")
    fixed = trials("circle", fusion.pose_filter, heading="yaw", fixes=station)
    covariance = free.estimate.covariance[:, 1:]
    spread = np.linalg.eigvalsh(covariance[..., :2, :2].mean(axis=0)).sum(axis=-1)
    seconds = spread[::30]
    assert (np.diff(seconds) > 0).all()
    assert seconds[-1] > 1.8 * seconds[len(seconds) // 2]
    assert fixed.sigma_xy[-1] < 0.5 * free.sigma_xy[-1]
    assert fixed.band[0] < fixed.mean_nees < fixed.band[1]


def test_one_run_is_filtered_as_it_is_among_many():
    many = drives.record("rectangle", runs=3)
    start = fusion.starts(many)
    among = fusion.pose_filter(many, start=start)
    alone = drives.Recording(
        **{
            **{name: getattr(many, name) for name in ("name", "time", "truth_time", "truth")},
            **{name: getattr(many, name)[1] for name in ("left", "right", "gyro", "yaw", "bias")},
            "turning": 1.0,
        }
    )
    single = fusion.pose_filter(alone, start=start[1])
    np.testing.assert_allclose(single.pose, among.pose[1], atol=1e-10)
    np.testing.assert_allclose(single.covariance, among.covariance[1], atol=1e-12)
    assert single.nis.shape == among.nis.shape[1:]


@pytest.mark.parametrize("name", drives.names())
def test_the_files_are_localised_within_what_the_filter_claims(name):
    recording = drives.load(name)
    estimate = fusion.pose_filter(recording, heading="yaw", turning_walk=0.002)
    error = recording.truth_at(estimate.time[30:]) - estimate.pose[30:]
    nees = kalman.nees(error, estimate.covariance[30:], angles=(2,))
    _, high = kalman.chi_square_band(3, 1, 0.9999)
    assert nees.mean() < high
    assert (nees < high).mean() > 0.95


@pytest.mark.parametrize(
    "options, message",
    [
        ({"heading": "compass"}, "heading must be one of rate, yaw, None"),
        ({"turning": 0.0}, "turning must be one number above 0"),
        ({"turning_std": -1.0}, "turning_std must be one number at least 0"),
        ({"slip": False, "turning_std": 0.1}, "turning_std says that the slip is not known"),
        ({"start": [0.0, 0.0]}, "start must be x, y, heading"),
        ({"start_std": [0.1, 0.1, 0.0]}, "start_std must be one number above 0"),
        ({"gyro_period": 0.0}, "gyro_period must be one number above 0"),
        ({"bias_walk": np.nan}, "bias_walk must be one number at least 0"),
        ({"rate": 1e4}, "faster than the samples"),
        (
            {"fixes": [fusion.Fix(500.0, np.zeros(2), 1.0)]},
            "a fix at 500 s is outside the drive",
        ),
    ],
)
def test_the_pose_filter_refuses_what_makes_no_sense(drive, options, message):
    with pytest.raises(ValueError, match=message):
        fusion.pose_filter(drive, **options)


def test_what_is_no_recording_or_no_fix_is_named(drive):
    with pytest.raises(TypeError, match="recording must be a Recording, got ndarray"):
        fusion.pose_filter(np.zeros(3))
    with pytest.raises(TypeError, match="each of fixes must be a Fix, got tuple"):
        fusion.pose_filter(drive, fixes=[(1.0, 2.0)])


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: fusion.Fix(1.0, np.zeros(3), 1.0), "value must end in 2"),
        (lambda: fusion.Fix(-1.0, np.zeros(2), 1.0), "time must be one number at least 0"),
        (lambda: fusion.Fix(1.0, np.zeros(2), 0.0), "std must be one number above 0"),
    ],
)
def test_a_malformed_fix_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_fixes_come_at_the_period_with_the_noise_that_they_say():
    recording = drives.record("circle", runs=40)
    fixes = fusion.total_station(recording, 5.0, np.random.default_rng(1), start=5.0)
    np.testing.assert_allclose([fix.time for fix in fixes], np.arange(5, 180.1, 5), atol=0.02)
    errors = np.array([fix.value - recording.truth_at(fix.time)[:2] for fix in fixes])
    assert errors.std() == pytest.approx(fusion.STATION_STD, rel=0.05)
    with pytest.raises(ValueError, match="period must be one number above 0"):
        fusion.total_station(recording, 0.0, np.random.default_rng(1))


# What no measurement shows


@pytest.mark.parametrize("name", SCENARIOS)
@pytest.mark.parametrize(
    "seen, names",
    [
        (("rate",), ("x", "y", "psi")),
        (("yaw",), ("x", "y")),
        (("rate", "yaw"), ("x", "y")),
        (("rate", "position"), ()),
        (("yaw", "position"), ()),
        (("yaw", "landmark"), ()),
    ],
)
def test_no_heading_sensor_shows_the_position_and_a_fix_does(name, seen, names):
    found = fusion.unobservable(name, seen)
    assert found.names == names
    assert found.directions.shape == (len(found.unknown), len(names))


def test_one_landmark_leaves_the_turn_about_it_unobservable():
    point = np.array([3.0, 20.0])
    found = fusion.unobservable("g", ("rate", "landmark"), landmark=point)
    assert found.directions.shape[1] == 1
    about = np.array([point[1], -point[0], 1.0])
    direction = found.directions[:3, 0] / found.directions[2, 0]
    np.testing.assert_allclose(direction, about, atol=1e-6)


def test_the_jacobian_of_range_and_bearing_agrees_with_differences():
    point = np.array([4.0, -3.0])

    def seen(x):
        return [np.hypot(*(point - x[:2])), np.arctan2(*(point - x[:2])[::-1]) - x[PSI]]

    for x in random_states(20):
        wanted = kalman.numerical_jacobian(seen, x, angles=(1,))
        np.testing.assert_allclose(_range_and_bearing(*(point - x[:2])), wanted, atol=1e-6)


@pytest.mark.parametrize("seen", [(), ("gps",), "yaw"])
def test_what_is_seen_must_be_known_sensors(seen):
    with pytest.raises(ValueError, match="seen must be"):
        fusion.unobservable("g", seen)


# Monte Carlo


def test_a_trial_of_an_estimator_without_covariance_has_errors_only(trials):
    trial = trials("rectangle", fusion.dead_reckoning, drives.SLIPPING)
    assert trial.nees is None and trial.nis is None
    assert trial.rmse[0] > 1.0
    with pytest.raises(ValueError, match="odometry says nothing of its errors"):
        _ = trial.mean_nees
    with pytest.raises(ValueError, match="has no covariance"):
        _ = trial.sigma_xy


def test_one_run_is_no_trial():
    for runs in (1, None):
        with pytest.raises(ValueError, match="runs must be"):
            fusion.monte_carlo("g", fusion.dead_reckoning, runs=runs)


# RMSE and "improvement"


def test_rmse_of_equal_rates_is_the_usual_one():
    time = np.arange(101) * 0.05
    truth, wrong = RNG.normal(size=(2, 101, 3))
    wanted = np.sqrt(np.mean((truth - wrong) ** 2, axis=0))
    np.testing.assert_allclose(fusion.rmse(time, truth, time, wrong), wanted)


def test_rmse_takes_the_nearest_samples_of_different_rates():
    time, time_e = np.arange(0, 10.001, 0.01), np.sort(RNG.uniform(0, 10, 300))
    truth, estimate = np.sin(time)[:, None], np.cos(time_e)[:, None]
    first, last = time_e[0], time_e[-1]
    grid = first + 0.05 * np.arange(int((last - first) / 0.05 + 1e-9) + 1)
    errors = [
        truth[np.abs(time - t).argmin(), 0] - estimate[np.abs(time_e - t).argmin(), 0] for t in grid
    ]
    found = fusion.rmse(time, truth, time_e, estimate)
    assert found[0] == pytest.approx(np.sqrt(np.mean(np.square(errors))), rel=1e-3)


def test_rmse_wraps_angles_only_where_told():
    time = np.arange(11.0)
    truth, estimate = np.full((11, 1), np.pi - 0.1), np.full((11, 1), 0.1 - np.pi)
    wrapped = fusion.rmse(time, truth, time, estimate, period=1.0, angles=(0,))
    plain = fusion.rmse(time, truth, time, estimate, period=1.0)
    assert wrapped[0] == pytest.approx(0.2) and plain[0] == pytest.approx(2 * np.pi - 0.2)


def test_a_trials_rmse_is_that_of_its_errors(trials):
    trial = trials("rectangle", fusion.pose_filter, heading="yaw")
    plain = np.sqrt(np.mean(trial.error**2, axis=(0, 1)))
    np.testing.assert_allclose(trial.rmse, plain, rtol=0.03)


@pytest.mark.parametrize(
    "change, message",
    [
        ({"time": [0.0, 0.0, 1.0]}, "time must rise"),
        ({"signal": np.zeros((2, 1))}, r"signal must have shape \(3, k\)"),
        ({"estimate": np.full((3, 1), np.nan)}, "estimate must be finite"),
        ({"estimate": np.zeros((3, 2))}, r"estimate must have shape \(..., 3, 1\)"),
        ({"time_e": [5.0, 6.0, 7.0]}, "must overlap in time"),
        ({"period": 0.0}, "period must be one number above 0"),
    ],
)
def test_rmse_refuses_signals_that_do_not_match(change, message):
    time = np.arange(3.0)
    given = {"time": time, "signal": np.zeros((3, 1)), "time_e": time, "estimate": np.ones((3, 1))}
    given |= change
    period = given.pop("period", 0.05)
    with pytest.raises(ValueError, match=message):
        fusion.rmse(*given.values(), period=period)


def test_an_improvement_is_a_ratio_and_a_reduction():
    found = fusion.improvement([0.8, 0.3], [0.2, 0.3])
    np.testing.assert_allclose(found.ratio_percent, [400, 100])
    np.testing.assert_allclose(found.reduction_percent, [75, 0])


@pytest.mark.parametrize(
    "pair, message",
    [
        ((0.0, 1.0), "odometry must be errors above 0"),
        ((1.0, np.nan), "filtered must be finite"),
        (([1.0, 2.0], [1.0]), "odometry and filtered must be alike"),
    ],
)
def test_an_improvement_needs_two_errors(pair, message):
    with pytest.raises(ValueError, match=message):
        fusion.improvement(*pair)


# Sample by sample


def test_the_localiser_says_what_the_filter_says_of_the_whole_drive():
    recording = drives.record("rectangle", rate=50.0, turning=drives.SLIPPING)
    prior = (0.85, 0.15)
    localiser = fusion.Localiser(turning=prior, turning_walk=0.0)
    localiser.reset(recording.truth[0])
    samples = zip(recording.left[1:], recording.right[1:], recording.gyro[1:], strict=True)
    poses = np.array([localiser(*sample, None, 0.02) for sample in samples])
    whole = fusion.pose_filter(recording, rate=50.0, use="latest")
    np.testing.assert_allclose(poses, whole.pose[1:], atol=1e-8)
    np.testing.assert_allclose(localiser.x[PSI], whole.state[-1, PSI])
    np.testing.assert_allclose(np.diag(localiser.P)[:5], whole.std[-1, :5] ** 2, rtol=1e-6)


def test_the_odometer_goes_the_way_of_dead_reckoning(drive):
    odometer, pose = fusion.Odometer(turning=drives.SLIPPING), drive.truth[0]
    for left, right in zip(drive.left[1:], drive.right[1:], strict=True):
        pose = odometer(pose, left, right, 0.01)
    whole = fusion.dead_reckoning(drive, turning=drives.SLIPPING)
    np.testing.assert_allclose(pose, whole.pose[-1], atol=1e-9)


def test_a_fix_pulls_the_localiser_to_it():
    localiser = fusion.Localiser()
    for _ in range(200):
        before = localiser(2.0, 2.0, 0.0, None, 0.02)
    after = localiser(2.0, 2.0, 0.0, before[:2] + np.array([0.1, 0.0]), 0.02)
    assert 0.0 < after[0] - before[0] - 0.014 < 0.1
    assert localiser.P[0, 0] < fusion.STATION_STD**2


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: fusion.Odometer(turning=0.0), "turning must be one number above 0"),
        (lambda: fusion.Localiser(fix_std=0.0), "fix_std must be one number above 0"),
        (lambda: Model(period=-1.0), "period must be one number at least 0"),
    ],
)
def test_settings_of_the_parts_are_checked(make, message):
    with pytest.raises(ValueError, match=message):
        make()
