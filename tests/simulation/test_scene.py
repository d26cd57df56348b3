"""The scene's heaps and banks."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from backhoe.simulation.scene import FADING, GRADING, Bank, Heap


def test_a_heap_is_as_high_as_it_says_and_ends_at_its_radius():
    heap = Heap(x=2.0, y=-1.0, height=1.5, radius=2.0)
    x = 2.0 + np.array([0.0, 1.0, 2.0, 5.0])
    assert heap.height_at(x, np.full(4, -1.0)) == pytest.approx([1.5, 0.75, 0.0, 0.0])


def test_a_bank_is_its_slope_and_between_the_two_surpluses_more():
    bank = GRADING.bank
    x, _ = GRADING.grid()
    design = np.clip(x - bank.foot[0], 0, bank.length * 2 / np.sqrt(5)) / 2
    for seed in (0, 1):
        more = GRADING.heights(seed) - design
        on = (x > bank.foot[0] + FADING) & (x < bank.foot[0] + 5.3)
        assert more[on].min() >= bank.surplus[0]
        assert more[on].max() <= bank.surplus[1]
        assert np.ptp(more[on]) > 0.4 * np.ptp(bank.surplus)
        assert_allclose(more[x <= bank.foot[0]], 0.0, atol=1e-12)
        assert_allclose(more[x > bank.foot[0] + 5.37 + 2 * FADING], 0.0, atol=1e-12)
    assert not np.array_equal(GRADING.heights(0), GRADING.heights(1))
    assert np.array_equal(GRADING.heights(1), GRADING.heights(1))


def test_a_turned_bank_rises_where_it_is_turned_to():
    bank = Bank(foot=(1.0, 2.0), direction=np.pi / 2, ratio=3.0, length=2.0, surplus=(0.0, 0.0))
    y = np.array([1.0, 2.0, 2.6, 9.0])
    heights = bank.heights_at(np.full(4, 7.0), y, np.random.default_rng(0))
    assert_allclose(heights, [0.0, 0.0, 0.2, 2 / np.sqrt(10)], atol=1e-12)


@pytest.mark.parametrize(
    "wrong",
    [{"ratio": 0.0}, {"length": -1.0}, {"surplus": (0.2, 0.1)}, {"surplus": (-0.1, 0.1)}],
)
def test_a_bank_that_cannot_be(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        Bank(foot=(0.0, 0.0), **wrong)
