"""A load in the air: a right model is rewarded, and what is wrong with one moves a number."""

import numpy as np
import pytest

from backhoe import mission
from backhoe.arm import dynamics
from backhoe.lessons.dynamics import exercises
from backhoe.machine import BACKHOE
from backhoe.machine.variants import loaded
from backhoe.mission import lifting

_, GRAVITY, INERTIA, *_ = exercises.EXERCISES
NOISE = 0.01  # between the backends [deg]; two runs on one are the same
RIGHT = np.array([0.003, 0.0])  # of a right model, on the way and at rest [deg]


def errors(**parts):
    found = mission.score(mission.lift(backend="analytic", **parts))
    return np.degrees([found.moving, found.resting])


@pytest.fixture(scope="module")
def library():
    return errors()


def test_the_way_is_within_the_limits_of_speed_and_torque():
    time, q, dq, ddq = lifting._way(0.01)
    assert (np.abs(dq) < BACKHOE.speed_limit).all()
    assert ((BACKHOE.lower < q) & (q < BACKHOE.upper)).all()
    torque = [dynamics.inverse_dynamics(*one, machine=loaded(1e3)) for one in zip(q, dq, ddq)]  # noqa: B905
    assert (np.abs(torque) < BACKHOE.torque_limit).all()
    np.testing.assert_allclose(np.gradient(q, time, axis=0)[1:-1], dq[1:-1], atol=0.01)
    np.testing.assert_allclose(np.gradient(dq, time, axis=0)[1:-1], ddq[1:-1], atol=0.03)


def test_right_parts_that_know_the_load_win_against_the_library(library):
    right = errors(gravity_torque=dynamics.gravity_torque, inertia_matrix=INERTIA.reference)
    np.testing.assert_allclose(right, RIGHT, atol=0.0006)
    assert (library > 5 * NOISE).all()


@pytest.mark.parametrize("mistake", list(GRAVITY.mistakes)[::6])
def test_a_mistake_in_the_gravity_torque_moves_both_numbers(mistake, library):
    off = errors(gravity_torque=GRAVITY.mistakes[mistake], inertia_matrix=INERTIA.reference)
    assert (off > RIGHT + 0.002).all()


@pytest.mark.parametrize("mistake", list(INERTIA.mistakes)[::6])
def test_a_mistake_in_the_inertia_matrix_moves_the_error_on_the_way(mistake):
    assert errors(inertia_matrix=INERTIA.mistakes[mistake])[0] > RIGHT[0] + 0.01


def test_both_backends_agree(library):
    pytest.importorskip("pybullet")
    run = mission.score(mission.lift(backend="pybullet"))
    np.testing.assert_allclose(np.degrees([run.moving, run.resting]), library, atol=NOISE)


def test_the_score_stands_beside_the_librarys_and_the_replay_is_the_students():
    run = mission.lift(inertia_matrix=INERTIA.reference, backend="analytic", record=True)
    table = str(mission.score(run)).splitlines()
    assert table[0] == "swapped in: inertia_matrix"
    assert table[2].split()[-2:] == ["0.003", "0.378"]
    assert run.replay()


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        ({"load": -1.0}, ValueError, "load"),
        ({"inertia_matrix": lambda q, load: np.eye(3)}, ValueError, "your inertia_matrix failed"),
        ({"gravity_torque": lambda q: None}, ValueError, "your gravity_torque failed"),
        ({"controller": min}, TypeError, "unknown part 'controller'"),
    ],
)
def test_bad_parts_are_refused(call, error, message):
    with pytest.raises(error, match=message):
        mission.lift(backend="analytic", **call)
