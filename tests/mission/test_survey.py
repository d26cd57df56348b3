"""A survey beside the truth, and what becomes of its numbers with a wrong part."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from backhoe import mission
from backhoe.mission.surveying import SurveyRun
from backhoe.perception.octree import OccupancyOctree

SEEDS = 0, 1


@lru_cache
def library(seed: int = 0) -> SurveyRun:
    return mission.survey(seed=seed)


def test_the_map_finds_what_the_beams_end_at_and_little_else():
    for seed in SEEDS:
        run = library(seed)
        assert run.found.min() > 0.9
        assert run.false[-1] < 0.1
        assert run.dark == 1.0


def test_the_truck_that_left_is_gone_after_as_many_looks_as_clear_a_sure_voxel():
    fresh = OccupancyOctree(0.2)
    looks = int(np.floor(fresh.l_max / -fresh.miss)) + 1
    for seed in SEEDS:
        run = library(seed)
        away = [k for k, event in enumerate(run.events) if event == "the truck has left"]
        assert len(away) == looks == 5
        assert np.isnan(run.left[: away[0]]).all()
        assert run.left[away[0]] > 0.5
        assert run.left[away[-1]] < 0.02
