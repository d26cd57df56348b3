"""What lesson 05 accepts and claims beside its references, which `oracles` proves."""

import pytest

from backhoe.lessons import published
from backhoe.lessons.path_tracking.exercises import own
from backhoe.vehicle import skid_steer, tracking


def test_trackers_of_the_library_pass_as_ones_own():
    assert own.judged(tracking.ScagliaTaylor(), None) is True
    assert own.judged(tracking.ScagliaLinear(), None) is True


def test_a_slow_tracker_on_the_line_is_told_that_it_is_late():
    pursuer = tracking.PurePursuit(0.2, speed=0.2)
    assert "not to the time" in own.judged(pursuer, None)


def _compared(paths, controllers=("P", "PI")):
    """The runs of section 8: the lesson's gains on the linear model, in path mode."""
    gains = {"P": (4.0,), "PI": (4.0, 1.0)}
    trackers = {
        name: tracking.PIDTracker(rho=(1.0,), dy=gains[name], alpha=(1.0,)) for name in controllers
    }
    return tracking.compare(
        trackers,
        paths,
        lambda: skid_steer.SkidSteerPlant(dt=0.05, model="linear"),
        limits=tracking.Limits.of(skid_steer.HUSKY, 1.0),
        period=0.1,
    )


def test_on_circle_and_eight_the_best_values_are_those_that_table_51_prints_in_bold():
    bold = published.load("dangelo_2022_table_51")["bold"]
    compared = _compared({"circle": tracking.circle(), "figure_eight": tracking.figure_eight()})
    for row, path in enumerate(compared.paths):
        for field in tracking.Metrics._fields:
            best = compared.best(field)[row]
            names = [name for name, marked in zip(compared.trackers, best, strict=True) if marked]
            assert names == bold[path][field], (path, field)


def test_a_square_of_1_2_m_has_the_four_numbers_that_table_51_prints_for_p():
    square = {"square": tracking.square(1.2), "too large": tracking.square(2.0)}
    values = _compared(square, ("P",)).values
    printed = published.load("dangelo_2022_table_51")["P"]["square"]
    for field, value in printed.items():
        within = 0.0055 if field == "d_ratio" else 0.0025
        assert values[field][0, 0] == pytest.approx(value, abs=within)
    assert values["d_ratio"][1, 0] > printed["d_ratio"] + 0.05


@pytest.mark.parametrize(
    "make", [tracking.ScagliaTaylor, tracking.ScagliaLinear, tracking.ScagliaRungeKutta]
)
def test_the_gains_of_fig_63_steer_otherwise_with_every_sample_time(make):
    half_track = skid_steer.turning_half_track(skid_steer.HUSKY)
    eight = tracking.figure_eight().with_times(0.3)
    limits = tracking.Limits(6.0, skid_steer.HUSKY.wheel_radius, half_track)
    steering = []
    for period in (0.05, 0.2, 0.4):
        plant = skid_steer.SkidSteerPlant(dt=0.05, model="slipping", half_track=half_track)
        run = tracking.follow(make(), plant, eight, mode="trajectory", period=period, limits=limits)
        steering.append(tracking.assess(run).change_omega)
    assert steering[0] > 3 * steering[1] > 5 * steering[2]
