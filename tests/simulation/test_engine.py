"""The compiled laws are the plain ones."""

import numpy as np
import pytest

from backhoe.arm.dynamics import terms
from backhoe.machine import BACKHOE
from backhoe.simulation import engine, forces, moving_base

RNG = np.random.default_rng(5)
NUMBERS = forces.numbers_of(BACKHOE, friction=True)
NUMBERS.load[1] = 700.0


def moving(speed=1.0):
    """A machine on its way: beyond some of its stops, soil at its tip, its tracks sheared."""
    memory = forces.memory_of(NUMBERS)
    state = forces.state_in(memory)
    state.q[:] = RNG.uniform(-2.5, 2.5, 7)
    state.dq[:] = RNG.normal(0, speed, 7)
    state.soil[:] = RNG.normal(0, 2e4, 4)
    state.sheared[:] = RNG.uniform(-1, 1, state.sheared.shape)
    state.belts[:] = RNG.uniform(-1.5, 1.5, 2)
    return memory


@pytest.mark.parametrize("driven, size", [(False, 2.0), (True, 8e4)])
def test_a_push_is_the_plain_push(driven, size):
    for _ in range(100):
        plain, torque, command = moving(), RNG.normal(0, 3e5, 4), RNG.normal(0, size, 2)
        fast = plain.copy()
        assert forces.push(NUMBERS, plain, torque, command, driven, 0.001)
        assert engine.push(tuple(NUMBERS), fast, torque, command, driven, 0.001)
        np.testing.assert_allclose(fast, plain, rtol=1e-12, atol=1e-9)


def test_what_is_not_finite_changes_nothing_in_either():
    for push in (forces.push, engine.push):
        memory = moving()
        before = memory.copy()
        for torque, command in (([0, 0, np.nan, 0], [0, 0]), ([0, 0, 0, 0], [np.inf, 0])):
            arrays = np.array(torque, float), np.array(command, float)
            assert not push(tuple(NUMBERS), memory, *arrays, False, 0.001)
        np.testing.assert_array_equal(memory, before)


def test_the_tips_motion_is_the_plain_one():
    for _ in range(50):
        q, dq = RNG.uniform(-3, 3, (2, 7))
        for one, other in zip(
            forces.tip_motion(NUMBERS.reach, q, dq),
            engine.tip_motion(NUMBERS.reach, q, dq),
            strict=True,
        ):
            np.testing.assert_allclose(other, one, rtol=1e-12, atol=1e-12)


def test_the_balance_of_a_moving_base_is_the_plain_one():
    arm, carrier = terms.arm_of(BACKHOE), moving_base.carrier_of(BACKHOE)
    for _ in range(50):
        (q, dq), (M, left) = RNG.uniform(-3, 3, (2, 7)), (np.empty((7, 7)), RNG.normal(0, 1e5, 7))
        M_fast, left_fast = np.empty((7, 7)), left.copy()
        moving_base.balance(arm, carrier, q, dq, M, left)
        engine.balance(arm, carrier, q, dq, M_fast, left_fast)
        np.testing.assert_allclose(M_fast, M, rtol=1e-12, atol=1e-12 * np.abs(M).max())
        np.testing.assert_allclose(left_fast, left, rtol=1e-12, atol=1e-12 * np.abs(left).max())
