"""The slides' robot in PyBullet: what its drives do, and beside the model that only moves."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from backhoe.simulation.mobile_arm import LAG, STEP, MobileArm, mobile_arm_urdf
from backhoe.whole_body import (
    BACKHOE,
    SLIDES,
    KinematicPlant,
    SlidesRobot,
    circle_path,
    eight_path,
    follow,
    hand,
    sine_path,
)

pybullet = pytest.importorskip("pybullet")

Q = np.array([0.5, 0.3, 0.4, 0.2, 0.9, -1.2])
PATHS = {
    "sine": sine_path(hand(Q, SLIDES), 12, length=2.0, waves=1.5, sideways=0.3, upwards=0.05),
    "circle": circle_path(hand(Q, SLIDES), 10, radius=0.35, tilt=0.3),
    "eight": eight_path(hand(Q, SLIDES), 12, length=0.8, width=0.4, height=0.2),
}
SLIP = 0.005
"""Of the wheels, as share of a speed: measured below."""


def test_speeds_lag_and_are_then_those_told_but_for_a_little_slip():
    told = np.array([0.3, 0.4, 0.3, -0.2, 0.3])
    with MobileArm(SLIDES, Q, dt=0.01) as plant:
        model = KinematicPlant(SLIDES, Q, dt=0.01, lag=LAG)
        for _ in range(10):
            plant.step(told)
            model.step(told)
        assert_allclose(plant.v[1:], model.v[1:], atol=2e-3)
        assert_allclose(plant.v[0], model.v[0], atol=0.04)  # meanwhile the body nods
        for _ in range(190):
            plant.step(told)
            model.step(told)
        assert_allclose(plant.v, told, rtol=SLIP)
        # each wanted speed stands for the whole of its step: half a step early
        assert_allclose(plant.q[3:] - model.q[3:], STEP / 2 * told[2:], rtol=0.2)
        assert plant.time == pytest.approx(2.0)


def test_it_stands_still_with_its_arm_out():
    with MobileArm(SLIDES, [0, 0, 0, 1.2, 0.0, 0.0], dt=0.1) as plant:
        for _ in range(20):
            plant.step(np.zeros(5))
        assert_allclose(plant.q, [0, 0, 0, 1.2, 0, 0], atol=2e-3)
        assert_allclose(plant.v, 0, atol=1e-3)


@pytest.mark.parametrize("robot", [SLIDES, SlidesRobot(0.3, 0.5, 0.4, 0.2)])
def test_bullet_has_the_hand_where_the_model_has_it(robot):
    with MobileArm(robot, Q) as plant:
        link = plant._drives[-1]
        foot = np.array(plant._server.getLinkState(plant._body, link, 0, 1)[4])
        turn = np.reshape(
            pybullet.getMatrixFromQuaternion(plant._server.getLinkState(plant._body, link)[5]),
            (3, 3),
        )
        at = foot + robot.l3 * turn[:, 0]
        assert_allclose(at, hand(plant.q, robot), atol=2e-3)


@pytest.mark.parametrize("kind", PATHS)
@pytest.mark.parametrize("known", [0.0, LAG])
def test_it_follows_a_path_as_the_model_with_lags_does(kind, known):
    """Apart by the half step that its drives are early, and by slip against the feedback."""
    path, dt, W = PATHS[kind], 0.1, 0.5
    with MobileArm(SLIDES, Q, dt=dt) as plant:
        run = follow(plant, path, W=W, lag=known)
    model, blind = (
        follow(KinematicPlant(SLIDES, Q, dt=dt, lag=LAG), path, W=W, lag=lag)
        for lag in (known, 0.0)
    )
    fastest = np.linalg.norm(path.velocity(run.time), axis=1).max()
    bound = STEP / 2 / LAG * blind.error.max() + SLIP * fastest * dt / (1 - W)
    assert np.linalg.norm(run.hand - model.hand, axis=1).max() < bound < 7e-4
    assert run.error.max() < (1.2e-3 if known else 6e-3)


def test_two_runs_are_the_same_to_the_last_bit():
    ends = []
    with MobileArm(SLIDES, Q) as plant:
        for _ in range(2):
            ends.append(follow(plant, PATHS["eight"], duration=3.0).q)
            plant.reset()
    assert_array_equal(*ends)


def test_its_description_names_its_drives_and_bad_arguments_are_refused():
    assert all(f'joint name="{name}"' in mobile_arm_urdf() for name in ("left", "right", "q3"))
    with pytest.raises(TypeError, match="SlidesRobot"):
        MobileArm(BACKHOE)
    for options in ({"dt": 0.012}, {"lag": 0.0}):
        with pytest.raises(ValueError, match=next(iter(options))):
            MobileArm(**options)
    with MobileArm() as plant, pytest.raises(ValueError, match="u, omega"):
        plant.step(np.zeros(6))
    plant.close()
    with pytest.raises(RuntimeError, match="closed"):
        plant.step(np.zeros(5))
