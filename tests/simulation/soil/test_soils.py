from dataclasses import fields, replace
from math import degrees, pi, radians

import numpy as np
import pytest

from backhoe import mission, simulation
from backhoe.machine import BACKHOE
from backhoe.simulation.soil import SANDY_LOAM, SOILS, SoilParameters, soil_of
from backhoe.simulation.soil.soils import SOURCES, UNITS

BUCKET = BACKHOE.shell.struck_capacity
RANGES = {
    "dry sand": {"cohesion": (0, 0), "friction": (25, 30), "tool_friction": (16, 17.5)},
    "gravel": {"cohesion": (0, 0), "friction": (38, 38), "tool_friction": (21.5, 22.5)},
    "sandy loam": {"cohesion": (5e3, 15e3), "friction": (30, 40), "tool_friction": (20, 22)},
    "loam": {"cohesion": (20e3, 20e3), "friction": (20, 20), "tool_friction": (10, 10)},
    "clay loam": {"cohesion": (30e3, 30e3), "friction": (10, 10), "tool_friction": (6, 6)},
    "stiff clay": {"cohesion": (50e3, 50e3), "friction": (20, 20), "tool_friction": (10, 14)},
}
"""Strength as the cited tables print it [Pa, degrees]."""


def test_every_number_of_every_soil_has_a_unit_and_a_source():
    names = {field.name for field in fields(SoilParameters)}
    assert set(UNITS) == names
    assert set(SOURCES) == set(SOILS) and len(SOILS) >= 5
    for of_soil in SOURCES.values():
        assert set(of_soil) == names
        assert all(text.startswith("ours: ") or "/" in text for text in of_soil.values())


@pytest.mark.parametrize("name", SOILS)
def test_strengths_are_those_of_the_cited_tables(name):
    soil = SOILS[name]
    for field, (low, high) in RANGES[name].items():
        value = getattr(soil, field)
        value = value if field == "cohesion" else degrees(value)
        assert low - 1e-9 <= value <= high + 1e-9
    assert 11e3 / 9.81 < soil.density < 21e3 / 9.81
    assert 4.8e6 <= soil.subgrade <= 80e6


def test_a_soil_is_found_by_its_name():
    assert soil_of("clay loam") is SOILS["clay loam"]
    assert soil_of(SANDY_LOAM) is SANDY_LOAM == SoilParameters()
    for bad in ("mud", 3, None, ["loam"]):
        with pytest.raises(ValueError, match="soil must be one of dry sand, gravel, sandy loam, "):
            soil_of(bad)


def test_a_world_has_the_soil_that_it_is_given():
    hard = replace(SANDY_LOAM, cohesion=20e3)
    for soil, wanted in ((True, SANDY_LOAM), ("gravel", SOILS["gravel"]), (hard, hard)):
        with simulation.open_world(backend="analytic", soil=soil) as world:
            assert world.ground.parameters == wanted
            world.reset()
            assert world.ground.parameters == wanted
    with simulation.open_world(backend="analytic", soil=False) as world:
        assert world.ground is None
    with pytest.raises(ValueError, match=r"soil must be one of .*stiff clay, got 'mud'"):
        simulation.open_world(backend="analytic", soil="mud")
    with pytest.raises(ValueError, match=r"soil must be one of .*stiff clay, got 'mud'"):
        mission.run(soil="mud", cycles=1)
    with (
        simulation.open_world(backend="analytic") as world,
        pytest.raises(ValueError, match="soil is that of the given world"),
    ):
        mission.run(world=world, soil="gravel", cycles=1)


def thinner(by):
    """The hand-made plan, cutting less deep by some metres."""

    def plan(cycle):
        return [
            replace(point, target=(*point.target[:2], point.target[2] + by, point.target[3]))
            if point.name in ("cut in", "pull", "curl")
            else point
            for point in mission.hand_made_plan(cycle)
        ]

    return plan


@pytest.mark.parametrize("name", SOILS)
def test_every_soil_can_be_dug_and_loaded(name):
    """The clays in thinner slices, as one would."""
    by = 0.3 if SOILS[name].cohesion >= 20e3 else 0.0
    run = mission.run(plan=thinner(by), cycles=1, soil=name, backend="analytic")
    assert run.soil == SOILS[name]
    assert run.truck_volume[-1] > (0.8 if by else 1.2) * BUCKET
    assert run.least.margin > 0.1
    assert run.soil_lost < 1e-6 * BUCKET
    assert np.abs(np.diff(run.q, axis=0)).max() / 0.01 < BACKHOE.speed_limit.max()


def test_a_full_slice_of_clay_tips_the_machine_and_the_message_says_by_what():
    said = r"over its front edge .* while the soil held the bucket with"
    with pytest.raises(simulation.Tipped, match=said) as caught:
        mission.run(cycles=1, soil="stiff clay", backend="analytic")
    assert caught.value.run.least.margin < 0
    assert np.abs(caught.value.run.q).max() < 2 * pi


def test_a_soil_too_hard_for_the_machine_holds_the_arm_back():
    """On a base that cannot tip: it is late everywhere in the heap, and nothing runs away."""
    rock = replace(SOILS["stiff clay"], cohesion=600e3, friction=radians(40))
    with simulation.open_world(backend="analytic", base="fixed", soil=rock) as world:
        run = mission.run(world=world, cycles=1)
    soft = mission.run(cycles=1, backend="analytic")
    assert run.least.margin < 0 < soft.least.margin
    digging = slice(1, 4)  # cut in, pull, curl
    late = [np.linalg.norm(r.reached[:, :3] - r.wanted[:, :3], axis=1) for r in (run, soft)]
    assert (late[0][digging] > 1.4 * late[1][digging]).all()
    assert np.abs(np.diff(run.q, axis=0)).max() / 0.01 < BACKHOE.speed_limit.max()


@pytest.mark.parametrize(
    "change, message",
    [
        ({"density": 0.0}, "soil density must be one number above 0"),
        ({"density": "heavy"}, "soil density must be one number above 0"),
        ({"cohesion": -1.0}, "soil cohesion must be one number at least 0"),
        ({"friction": float("nan")}, "soil friction must be one number above 0"),
        ({"repose": radians(50)}, "soil repose must be one number below 0.785"),
        ({"tool_friction": radians(40)}, "tool_friction must not exceed friction"),
        ({"adhesion": 7e3}, "adhesion must not exceed cohesion"),
        ({"spill_rate": 0.0}, "soil spill_rate must be one number above 0"),
    ],
)
def test_bad_parameters_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        replace(SANDY_LOAM, **change)
