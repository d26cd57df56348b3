"""With and without the homogeneous solution: what the slides conclude, and what holds."""

import numpy as np
import pytest

from backhoe import simulation
from backhoe.machine import BACKHOE as MACHINE
from backhoe.whole_body import (
    SLIDES,
    KinematicPlant,
    eight_path,
    follow,
    hand,
    manipulability_gradient,
    sine_path,
)

READY = np.array([0.0, 0.9, -1.4])
DIGGING = np.array([-1.4, 0.5, -0.8, 0.0])
PREFERENCES = ("nothing", "posture", "arm", "whole")
CLIMB = {"arm": 20.0, "whole": 1.0}  # up the manipulability [1/(m^3 s)]


def small_robot(preference):
    """Twice a level figure of eight in the model that only moves, T = 0.1 s and W = 0.5."""
    start = np.array([0.0, 0.0, 0.0, *READY])
    path = eight_path(
        hand(start, SLIDES), 60, length=2.2, width=2.0, height=0.16, heading=-0.75, turns=2
    )

    def prefer(q):
        if preference == "posture":
            speeds = READY - q[3:]
        else:
            speeds = CLIMB[preference] * manipulability_gradient(q, SLIDES, preference)
        return np.array([0.0, 0.0, *speeds])

    plant = KinematicPlant(SLIDES, start, dt=0.1)
    return follow(plant, path, W=0.5, preferred=None if preference == "nothing" else prefer)


def backhoe(homogeneous, backend="analytic"):
    """20 s along a sine with real drives and slip, T = 10 ms and W = 0.8."""
    path = sine_path(hand([0.0, 0.0, 0.0, *DIGGING]), 20, length=4.0, sideways=0.4, upwards=0.2)

    def back(q):
        return np.array([0.0, 0.0, *(DIGGING - q[3:])])

    with simulation.open_world(
        backend=backend, scene=simulation.FLAT, soil=False, q=DIGGING
    ) as world:
        plant = simulation.WholeBodyPlant(world)
        return follow(plant, path, W=0.8, preferred=back if homogeneous else None)


@pytest.fixture(scope="module")
def runs():
    return {preference: small_robot(preference) for preference in PREFERENCES}


def fastest(run):
    return float(np.abs(run.told).max())


def test_the_least_velocities_fold_the_arm_through_a_singularity_and_ask_for_twice_the_speed(runs):
    assert runs["nothing"].w_arm.min() < 1e-5
    assert fastest(runs["nothing"]) > 1.8 * fastest(runs["posture"])
    assert runs["nothing"].error.max() > 2 * runs["posture"].error.max()


def test_a_preferred_posture_keeps_the_arm_away_from_it(runs):
    assert runs["posture"].w_arm.min() > 0.02


def test_the_gradient_of_the_whole_does_not_keep_the_arm_away_and_that_of_the_arm_does(runs):
    """The slides' own secondary task: w stays high while the arm goes through w_arm = 0."""
    assert runs["whole"].w_arm.min() < 1e-5
    assert runs["whole"].w.min() > 0.3 > runs["arm"].w.min()
    assert runs["arm"].w_arm.min() > 0.02


def test_the_hand_is_on_its_way_whatever_the_arm_prefers(runs):
    assert max(run.error.max() for run in runs.values()) < 8e-3


def test_without_the_homogeneous_solution_the_bucket_runs_into_its_limit_and_off_the_path():
    without, with_it = backhoe(False), backhoe(True)
    assert without.q[:, 6].min() < MACHINE.lower[3] - 1e-3
    assert without.error.max() > 0.02
    assert np.abs(with_it.q[:, 3:] - DIGGING).max() < 0.45
    assert with_it.error.max() < 2e-3
