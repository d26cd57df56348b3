"""A load and a rock: the score tells a right controller from the usual mistakes."""

import numpy as np
import pytest

from backhoe import mission
from backhoe.arm import lyapunov, pid
from backhoe.lessons import published
from backhoe.lessons.lyapunov_pid.exercises import digital
from backhoe.machine import BACKHOE

LIMIT = BACKHOE.torque_limit
NUMBERS = "load", "swing", "overshoot", "home", "jumps"


def printed_numbers(score):
    """Label -> what is printed of this score alone."""
    rows = str(score).splitlines()[2:]
    return [row.split()[-2] for row in rows]


@pytest.fixture(scope="module")
def gains():
    kp = LIMIT / np.array([0.05, 0.1, 0.1, 0.1])
    tuned = lyapunov.tune("matrix", kp=kp, ki=0.4 * (kp - lyapunov.constants().kg), error=0.5)
    return tuned.gains


@pytest.fixture(scope="module")
def scored(gains):
    """A function: what a controller like 3.9's, with one thing changed, is worth alone."""

    def of(kp=gains.kp, ki=gains.ki, kd=gains.kd, time=0.005, **slip):
        step = digital._variant(*map(np.array, (kp, ki, kd)), 0.001, LIMIT, time, **slip)
        run = mission.hold(
            controller=lambda q_ref, rate, q, dq, dt: step(q_ref, rate, q), backend="analytic"
        )
        return mission.score(run)

    return of


@pytest.fixture(scope="module")
def right(scored):
    return scored()


def test_a_right_part_wins_three_rows_against_the_library(right):
    library = right.reference
    assert right.load < 0.5 * library.load
    assert right.overshoot < 0.5 * library.overshoot
    assert right.home < 0.2 * library.home


def test_each_usual_mistake_moves_a_printed_number(scored, right, gains):
    """The run is deterministic, so any change that is printed is beyond its noise."""
    thesis = published.load("mastalli_2013_eq_333")
    high = dict(zip(("kp", "ki", "kd"), (thesis[k] for k in ("K_p", "K_i", "K_d")), strict=True))
    slips = {
        "load": {"ki": 0 * np.array(gains.ki)},
        "overshoot": digital.SLIPS[digital.WINDS_UP],
        "home": high,
        "swing": {"divided": False},
        "jumps": {"time": 0.0},
    }
    for moved, slip in slips.items():
        wrong = scored(**slip)
        assert getattr(wrong, moved) > 2 * getattr(right, moved), moved
        assert printed_numbers(wrong) != printed_numbers(right)


def test_a_damper_of_the_wrong_sign_runs_away_and_the_score_says_so(scored):
    wrong = scored(turned=-1.0)
    assert np.isnan(wrong.load) and np.isinf(wrong.home)
    assert "nan" in str(wrong)


def test_a_run_repeats_bit_for_bit_and_starts_a_part_afresh():
    controller = pid.PID(*pid.ARM_GAINS, LIMIT)
    one, two = (mission.hold(controller=controller, backend="analytic") for _ in range(2))
    np.testing.assert_array_equal(one.q, two.q)
    alone = mission.hold(backend="analytic")
    np.testing.assert_array_equal(alone.q, one.q)
    assert not alone.swapped and mission.score(alone).reference is None


def test_the_rock_holds_the_bucket_and_the_drive_is_full():
    run = mission.hold(backend="analytic")
    held = (run.time > 6.5) & (run.time < 7.5)
    assert np.ptp(run.q[held, 3]) < np.radians(0.1)
    assert (run.torque[held, 3] > LIMIT[3]).all()
    assert np.degrees(run.q_ref[held, 3] - run.q[held, 3]).min() > 10


def test_wrong_parts_are_refused():
    with pytest.raises(TypeError, match="unknown part 'matcher'"):
        mission.hold(matcher=print)
    with pytest.raises(TypeError, match="controller"):
        mission.hold(controller=3)
    with pytest.raises(ValueError, match="your controller failed"):
        mission.hold(controller=lambda *given: np.zeros(3))
