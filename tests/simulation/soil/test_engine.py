"""The compiled loops over cells are the plain ones."""

from math import radians, tan

import numpy as np
import pytest

from backhoe.machine import BACKHOE
from backhoe.simulation.soil import cells, engine
from backhoe.simulation.soil.bucket_pose import BucketPose
from backhoe.simulation.soil.cells import Cells

PROFILE, HALF = np.array(BACKHOE.shell.profile), BACKHOE.shell.width / 2
CELL = 0.16


def hilly(seed, rows=30, columns=36, height=0.6):
    """Uneven soil over a floor, none of it looked at yet."""
    heights = np.random.default_rng(seed).uniform(0, height, (rows, columns))
    box = np.array([0, rows, 0, columns])
    ceiling = np.full_like(heights, np.inf)
    return Cells(heights, np.full_like(heights, -0.1), ceiling, box, -1.0, -2.0, CELL)


def pair(seed, **size):
    return hilly(seed, **size), hilly(seed, **size)


def alike(plain, fast):
    for name in ("heights", "ceiling", "box"):
        one, other = getattr(plain, name), getattr(fast, name)
        np.testing.assert_allclose(other, one, rtol=1e-12, atol=1e-12, err_msg=name)


def test_sliding_is_the_plain_sliding():
    plain, fast = pair(1)
    for sweeps in (1, 3, 40):
        limit = tan(radians(34)) * CELL
        assert cells.relax(plain, limit, sweeps) == engine.relax(tuple(fast), limit, sweeps)
        alike(plain, fast)


def test_digging_is_the_plain_digging():
    plain, fast = pair(2)
    rng, last = np.random.default_rng(3), BucketPose((3.2, 0.1, 0.5), (1.0, 0.0), -1.6)
    for _ in range(40):
        turn = rng.uniform(-0.3, 0.3)
        tip = rng.uniform((2.0, -0.5, -0.2), (3.6, 0.5, 0.5))
        here = BucketPose(tuple(tip.tolist()), (np.cos(turn), np.sin(turn)), rng.uniform(-3, 1))
        one = cells.dig(plain, PROFILE, HALF, last, here, 0.02)
        other = engine.dig(tuple(fast), PROFILE, HALF, tuple(last), tuple(here), 0.02)
        for a, b in zip(one, other, strict=True):
            assert b == pytest.approx(a, rel=1e-12, abs=1e-12)
        alike(plain, fast)
        depth = engine.cut_depth(tuple(fast), tuple(here), 0.2, HALF)
        assert depth == pytest.approx(cells.cut_depth(plain, here, 0.2, HALF), rel=1e-12)
        last = here
    assert (plain.heights == -0.1).any()


def test_laying_is_the_plain_laying():
    plain, fast = pair(4)
    for line in (((0.0, 0.0), (1.0, 1.0)), ((4.0, 0.0), (9.0, 0.0)), ((3.0, 1.0), (3.0, 1.0))):
        missed = engine.lay(tuple(fast), *line, 0.5, 0.3)
        assert missed == pytest.approx(cells.lay(plain, *line, 0.5, 0.3), rel=1e-12)
        alike(plain, fast)


def test_overflowing_is_the_plain_overflowing():
    (bed, fast_bed), (ground, fast_ground) = pair(5, rows=8, columns=9), pair(6)
    one, other = cells.overflow(bed, ground), engine.overflow(tuple(fast_bed), tuple(fast_ground))
    assert other == pytest.approx(one, rel=1e-12) and one[0] > 0
    alike(bed, fast_bed)
    alike(ground, fast_ground)
