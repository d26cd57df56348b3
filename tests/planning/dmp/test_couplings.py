"""A primitive is pushed aside by what its couplings say, and comes back to its goal."""

from __future__ import annotations

import numpy as np
import pytest

from backhoe.perception.distance_field import DistanceField
from backhoe.planning.dmp import DMP, keep_clear, keep_within, minimum_jerk

t = np.linspace(0, 5, 251)
STRAIGHT = np.column_stack([4 * minimum_jerk(t / 5)[0] - 2, np.zeros((len(t), 2))])


def learnt():
    return DMP(kernels=40).learn(STRAIGHT, t)


def pole(cell=0.1):
    """A pole along z that stands 0.05 m beside the middle of the straight way."""
    occupied = np.zeros((61, 61, 11), bool)
    occupied[30, 30] = True
    return DistanceField(occupied, cell, (-3.0, -2.95, -0.5))


@pytest.mark.parametrize("duration", [5.0, 10.0])
def test_a_pole_is_passed_with_the_clearance_less_a_fifth_of_what_the_path_lacks(duration):
    dmp, field = learnt(), pole()
    push = keep_clear(dmp, field, 0.5, duration=duration)
    _, x, _ = dmp.rollout(duration=duration, dt=duration / 1000, coupling=push)
    kept = field.query(x)[0].min()
    alone = field.query(STRAIGHT)[0].min()
    # slowly passed, the two springs are in balance: 4 (0.5 - kept) = kept - alone
    assert kept == pytest.approx((4 * 0.5 + alone) / 5, abs=0.04)
    assert np.abs(x[-1] - STRAIGHT[-1]).max() < 1e-3
    assert np.abs(x[0] - STRAIGHT[0]).max() == 0


def test_far_from_obstacles_nothing_changes():
    dmp = learnt()
    free = DistanceField(np.zeros((5, 5, 5), bool), 1.0, (-2, -2, -2))
    x = dmp.rollout(coupling=keep_clear(dmp, free, 0.5))[1]
    assert np.abs(x - dmp.rollout()[1]).max() < 1e-12


def test_limits_hold_but_for_a_fifth_of_what_is_beyond():
    dmp = learnt()
    push = keep_within(dmp, [-np.inf, -1, -1], [1.0, 1, 1])
    x = dmp.rollout(goal=[2.0, 0.0, 0.0], dt=0.005, coupling=push)[1]
    assert x[-1, 0] == pytest.approx(1 + 1.0 / 5, abs=1e-3)
    assert np.abs(x[:, 1:]).max() < 1e-12


def test_wrong_couplings_are_refused():
    dmp = learnt()
    with pytest.raises(ValueError, match="lower must be at most upper"):
        keep_within(dmp, [1, 1, 1], [0, 0, 0])
    with pytest.raises(TypeError, match="field must be a DistanceField"):
        keep_clear(dmp, None, 0.5)
    with pytest.raises(ValueError, match=r"coupling\(t, x, v\) must .* shape \(3,\)"):
        dmp.rollout(coupling=lambda t, x, v: [1.0])
    with pytest.raises(TypeError, match="coupling must be a function"):
        dmp.rollout(coupling=3.0)
