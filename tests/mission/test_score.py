"""What a score is made of and what the sensors of a drive show, on runs that are made up."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from backhoe.localisation.drives import Noise
from backhoe.machine import BACKHOE
from backhoe.mission import estimation, recorded
from backhoe.mission.score import _estimate_errors, _measure, _measure_drive, _measure_survey

RNG = np.random.default_rng(8)


def test_a_believed_heading_a_turn_away_is_right():
    pose = RNG.normal(size=(50, 3))
    estimate = (
        pose + np.array([0.3, 0.4, 2 * np.pi]) + np.outer(np.tile([1, -1], 25), [0.0, 0.0, 0.1])
    )
    errors = _estimate_errors(SimpleNamespace(estimate=estimate, pose=pose))
    assert errors == pytest.approx({"position_error": 0.5, "heading_error": 0.1})


def test_the_tracking_error_is_the_root_mean_square_in_the_air():
    error, air = np.full((6, 4), 9.0), np.array([True, False] * 3)
    error[air] = [0.1, -0.1, 0.3, -0.3]
    run = SimpleNamespace(
        reached=np.array([[3.0, 4.0, 0.0, 0.1]]),
        wanted=np.zeros((1, 4)),
        q=np.zeros((6, 4)),
        q_ref=error,
        in_the_air=air,
        truck_volume=[0.5, 2.0],
        time=[0.0, 7.0],
        least=SimpleNamespace(margin=1.0, time=2.0),
        swapped=(),
    )
    found = _measure(run)
    assert found.tracking == pytest.approx(np.sqrt(0.05))
    assert (found.waypoint_error, found.bucket_error, found.soil) == pytest.approx((5.0, 0.1, 1.5))


def test_the_force_of_a_track_is_a_root_mean_square_in_newtons():
    run = SimpleNamespace(
        traction=np.array([[9e9, 9e9], [3e4, -4e4], [-3e4, 4e4]]),
        metrics=SimpleNamespace(d_mean=0.0, d_max=0.0, d_ratio=1.0),
        assessment=SimpleNamespace(lag=0.0, time_error_mean=0.25, change_omega=3.0),
        time=[0.0, 1.0],
        reached=True,
        swapped=(),
        estimate=None,
        claims=np.empty((0, 3, 3)),
        long_steps=np.nan,
        least=None,
    )
    found = _measure_drive(run)
    assert found.push == pytest.approx(np.sqrt((9e8 + 16e8) / 2))
    assert "steering" not in str(found)
    shown = str(replace(found, swapped=("tracker",), late=0.021))
    rows = [line.split()[-1] for line in shown.splitlines()[2:]]
    assert rows[3:6] == ["0.02", "25.0", "3.0"]


class Standing:
    """A plant whose belts run and which turns, and nothing changes."""

    machine, belts, twist, pose = BACKHOE, np.array([0.7, 1.4]), np.array([0.5, 0.2]), np.zeros(3)
    time, dt = 0.0, 0.02

    def step(self, v, omega):
        pass


def readings(seed):
    """What a localisation is shown by sensors whose only fault is the gyro's bias."""
    seen = []

    def localisation(left, right, yaw_rate, fix, dt):
        seen.append((left, right, yaw_rate))
        return np.zeros(3)

    plant = estimation.EstimatedPlant(Standing(), {"localisation": localisation}, None, seed)
    for _ in range(3):
        plant.step(0.0, 0.0)
    return np.array(seen)


def test_encoders_show_rates_of_the_sprockets_and_the_gyro_has_a_bias_of_its_own(monkeypatch):
    monkeypatch.setattr(estimation, "NOISE", Noise(0.0, 0.0, 0.0, 0.0, gyro_bias=0.5))
    seen = np.array([readings(seed) for seed in range(200)])
    np.testing.assert_allclose(seen[..., 0], 2.0)
    np.testing.assert_allclose(seen[..., 1], 4.0)
    bias = seen[..., 2] - 0.2
    np.testing.assert_allclose(np.ptp(bias, axis=1), 0.0, atol=1e-12)
    assert bias[:, 0].std() == pytest.approx(0.5, rel=0.15)


def test_on_a_circle_the_accelerometer_is_pushed_towards_the_centre():
    t = np.arange(200) * 0.02
    v, omega = 1.5, 0.4
    rows = np.zeros((200, 9))
    rows[:, 0], rows[:, 3], rows[:, 4], rows[:, 5] = t, omega * t, v, omega
    np.testing.assert_allclose(recorded._motion(rows).acceleration, [[0.0, v * omega]] * 200)


def test_a_surveys_numbers_are_of_the_looks_that_they_say():
    faults = {"left": [10, 2], "right": [30, 3], "stereo": [200, 5]}
    seen = {name: SimpleNamespace(faults=np.array(pair)) for name, pair in faults.items()}
    rows = np.array([[0.5, 0.3, 0.0], [0.0, np.nan, np.nan], [0.7, 0.4, 0.0]])
    run = SimpleNamespace(
        heap={"stereo": rows, "lasers": rows + 0.1},
        clouds=[seen, seen],
        found=np.array([0.5, 1.0]),
        false=np.array([7.0, 0.2]),
        left=np.array([np.nan, 0.9, 0.3, 0.2, 0.1]),
        dark=0.8,
        swapped=(),
    )
    found = _measure_survey(run)
    assert (found.seen, found.covered, found.found) == pytest.approx((0.6, 0.7, 0.75))
    assert found.off == pytest.approx(np.sqrt((0.09 + 0.16) / 2))
    assert (found.wrong, found.strays) == pytest.approx((0.025, 0.125))
    assert (found.false, found.left, found.dark) == (0.2, 0.3, 0.8)
