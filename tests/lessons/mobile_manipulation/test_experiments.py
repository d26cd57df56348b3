"""With and without the homogeneous solution: what the slides conclude, and what holds."""

import numpy as np
import pytest

from backhoe.lessons.mobile_manipulation.experiments import (
    DIGGING,
    PREFERENCES,
    backhoe,
    small_robot,
)
from backhoe.machine import BACKHOE as MACHINE


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


def test_an_unknown_preference_is_refused():
    with pytest.raises(ValueError, match="preference"):
        small_robot("elbow")
    with pytest.raises(ValueError, match="homogeneous"):
        backhoe("yes")
