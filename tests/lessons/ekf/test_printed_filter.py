"""The thesis's filter and its ancestor, tried on the drives of the simulated machine."""

import numpy as np
import pytest

from backhoe.lessons import published
from backhoe.lessons.ekf import printed_filter
from backhoe.localisation import drives, fusion

SCENARIOS = tuple(drives.SCENARIOS)


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


@pytest.mark.parametrize("name", SCENARIOS)
def test_the_printed_filter_claims_far_more_than_it_knows(trials, name):
    trial = trials(name, printed_filter.as_printed)
    honest = 3  # of a pose, as many as its coordinates
    assert trial.band[0] < honest < trial.band[1]
    assert trial.mean_nees > 3 * honest
    assert trial.inside < 0.05
    slipping = trials(name, printed_filter.as_printed, drives.SLIPPING)
    assert slipping.mean_nees > 1000


def test_the_printed_filter_stops_growing_uncertain(trials):
    trial = trials("circle", printed_filter.as_printed)
    sigma = trial.sigma_xy
    assert np.ptp(sigma[len(sigma) // 10 :]) < 1e-6
    assert trial.scatter_xy[-1] > 10 * sigma[-1]


@pytest.mark.parametrize("turning", [1.0, drives.SLIPPING])
@pytest.mark.parametrize("name", SCENARIOS)
def test_the_printed_filter_cannot_gain_in_x_and_y_what_the_tables_print(trials, name, turning):
    reckoned = trials(name, fusion.dead_reckoning, turning)
    printed = trials(name, printed_filter.as_printed, turning)
    gain = fusion.improvement(reckoned.rmse[:2], printed.rmse[:2])
    least = min(
        published.load(f"mastalli_2013_table_4{k}")["improvement_percent"][axis]
        for k in (1, 2, 3)
        for axis in "xy"
    )
    assert (gain.ratio_percent < 105).all() and least > 150


def test_424_with_speeds_and_without_ts_overshoots_the_odometry(trials):
    still = trials("rectangle", printed_filter.as_printed)
    moving = trials("rectangle", printed_filter.as_printed, motion="printed")
    assert (moving.rmse[:2] > 10 * still.rmse[:2]).all()


def test_z_roll_and_pitch_of_the_printed_filter_touch_nothing_else(drive):
    estimate = printed_filter.as_printed(drive)
    np.testing.assert_array_equal(estimate.state[..., 2:5], 0.0)


def test_the_ancestor_follows_odometry_but_for_the_heading_that_it_averages():
    silent = drives.Noise(0, 0, 0, 0, 0)
    slipping = drives.record("g", turning=0.75, noise=silent)
    estimate = printed_filter.as_ancestor(slipping)
    half_way = (1 / 0.75 + 1) / 2
    assert estimate.pose[-1, 2] / slipping.truth[-1, 2] == pytest.approx(half_way, rel=0.01)


def test_the_ancestor_never_doubts_a_millimetre_however_far_it_goes(trials):
    trial = trials("circle", printed_filter.as_ancestor)
    assert np.ptp(trial.sigma_xy[100:]) < 0.005
    assert trial.sigma_xy[-1] < 0.01 < 1.0 < trial.scatter_xy[-1]
    assert trial.mean_nees > 1000


def test_settings_of_the_printed_filters_are_checked(drive):
    with pytest.raises(ValueError, match="motion must be one of still, printed"):
        printed_filter.as_printed(drive, motion="fast")
    with pytest.raises(ValueError, match="R_imu must be one number above 0"):
        printed_filter.as_ancestor(drive, R_imu=0.0)
