"""The scene's heaps."""

import numpy as np
import pytest

from backhoe.simulation.scene import Heap


def test_a_heap_is_as_high_as_it_says_and_ends_at_its_radius():
    heap = Heap(x=2.0, y=-1.0, height=1.5, radius=2.0)
    x = 2.0 + np.array([0.0, 1.0, 2.0, 5.0])
    assert heap.height_at(x, np.full(4, -1.0)) == pytest.approx([1.5, 0.75, 0.0, 0.0])
