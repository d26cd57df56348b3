"""What a score says of an odometry: long steps tell lines from arcs, and dt from a habit."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from backhoe import mission
from backhoe.localisation import odometry
from backhoe.machine import BACKHOE
from backhoe.mission import estimation
from backhoe.mission.estimation import EstimatedPlant
from backhoe.vehicle import tracking
from backhoe.vehicle.tracks import tracks_twist

DT = 0.02


def part(method="exact", dt=None):
    def odometry_of(pose, left, right, given):
        v, omega = tracks_twist(left, right, gauge=3.29)
        step = given if dt is None else dt
        return odometry.advance(pose, float(v) * step, float(omega) * step, method)

    return odometry_of


def driven(belts, **parts):
    """A plant whose belts run as told, (n, 2) [m/s], and what its odometry makes of it."""
    plant = SimpleNamespace(
        belts=None, twist=(0.0, 0.0), time=0.0, pose=np.zeros(3), dt=DT, machine=BACKHOE
    )
    seen = EstimatedPlant(plant, parts, None, 0)
    for plant.belts in belts:
        plant.time += DT
        seen.sense()
    return seen


def belts(seconds=12.0):
    t = np.arange(0, seconds, DT)
    return np.stack([0.5 + 0.2 * np.sin(0.3 * t), 0.9 + 0.1 * np.sin(0.2 * t)], axis=-1)


@pytest.mark.parametrize("method", ["exact", "midpoint", "euler"])
def test_long_steps_are_the_same_belts_laid_sample_by_sample_and_seldom(method):
    ran = belts()
    found = driven(ran, odometry=part(method)).in_long_steps()
    v, omega = ran.mean(axis=1), np.diff(ran)[:, 0] / 3.29
    fine = odometry.integrate(np.zeros(3), v, omega, DT, method)
    lengths = np.tile(estimation.LONG, 100)
    edges = np.append(0, np.cumsum(lengths))
    edges = edges[edges <= len(ran)]
    means = np.array([(v[a:b].mean(), omega[a:b].mean()) for a, b in pairwise(edges)])
    seldom = odometry.integrate(np.zeros(3), *means.T, DT * np.diff(edges), method)
    apart = np.hypot(*(fine[edges] - seldom)[:, :2].T)
    assert found == pytest.approx(np.sqrt(np.mean(apart**2)), rel=1e-9)


def test_long_steps_move_lines_by_decimetres_and_arcs_by_a_centimetre():
    off = {
        method: driven(belts(), odometry=part(method)).in_long_steps()
        for method in ("exact", "midpoint", "euler")
    }
    assert off["exact"] < 0.005 and off["midpoint"] < 0.02
    assert off["euler"] > 0.1


def test_a_part_with_a_step_of_its_own_is_seen_in_long_steps_alone():
    right, habit = (driven(belts(), odometry=part(dt=dt)) for dt in (None, DT))
    np.testing.assert_allclose(habit.estimates["odometry"], right.estimates["odometry"])
    assert habit.in_long_steps() > 0.5 > 100 * right.in_long_steps()


def test_long_steps_ignore_the_noise_of_the_rates_and_run_after_the_drive_too():
    seen = driven(belts(), odometry=part("euler"))
    assert seen.in_long_steps() == seen.in_long_steps()
    other = driven(belts(), odometry=part("euler"))
    other._rng = np.random.default_rng(5)
    assert other.in_long_steps() == seen.in_long_steps()


def test_the_score_prints_long_steps_for_an_odometry_and_for_nothing_else():
    path = tracking.from_points([[0.0, 0.0], [1.5, 0.0]]).with_times(0.5)
    runs = {
        name: mission.drive(path=path, backend="analytic", **given)
        for name, given in {
            "odometry": {"odometry": part()},
            "localisation": {"localisation": "library"},
            "truth": {},
        }.items()
    }
    said = {name: "in long steps off [cm]" in str(mission.score(run)) for name, run in runs.items()}
    assert said == {"odometry": True, "localisation": False, "truth": False}
    score = mission.score(runs["odometry"])
    assert score.long_steps == runs["odometry"].long_steps
    assert np.isfinite(score.reference.long_steps)
