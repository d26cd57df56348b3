"""Long batches in tiles: every item once, on any number of cores, errors not lost."""

import numpy as np
import pytest

from backhoe.basics import tiles


@pytest.mark.parametrize("count", [0, 1, 9, 10, 11, 79, 80, 81, 1000])
@pytest.mark.parametrize("cores", [1, 3])
def test_every_item_is_done_exactly_once(monkeypatch, count, cores):
    monkeypatch.setattr(tiles, "cores", lambda: cores)
    done = np.zeros(count, dtype=int)

    def work(tile):
        done[tile] += 1

    tiles.for_each_tile(work, count, 10)
    assert (done == 1).all()


@pytest.mark.parametrize("cores", [1, 3])
def test_an_error_in_a_tile_reaches_the_caller(monkeypatch, cores):
    monkeypatch.setattr(tiles, "cores", lambda: cores)

    def work(tile):
        if tile.start == 50:
            raise ValueError("tile 5")

    with pytest.raises(ValueError, match="tile 5"):
        tiles.for_each_tile(work, 200, 10)


def test_there_is_at_least_one_core():
    assert tiles.cores() >= 1
