from dataclasses import replace
from math import atan, cos, pi, radians, sin, tan

import numpy as np
import pytest

from backhoe.simulation.soil.earthmoving import (
    NO_CUT,
    bearing_capacity,
    cut,
    failure_angle,
    wedge,
)
from backhoe.simulation.soil.soils import SANDY_LOAM, SOILS, STIFF_CLAY, SoilParameters
from wedge import least, trial

RAKES = np.radians(np.arange(15.0, 100.1, 5.0))
CASES = [(0.05, 0.0, 9.81), (0.3, 6000.0, 9.81), (0.6, 2000.0, 1.62)]
"""Depth [m], surcharge [Pa], gravity [m/s^2]."""


def pushed(soil, depth, rake, width, surcharge, gravity):
    blade = cut(soil, depth, rake, width, surcharge, gravity)
    return np.array([blade.forward, blade.upward])


@pytest.mark.parametrize("soil", SOILS.values(), ids=SOILS)
@pytest.mark.parametrize("rake_deg", [15, 30, 50, 70, 90, 100])
@pytest.mark.parametrize(("depth", "surcharge", "gravity"), CASES)
def test_both_parts_of_the_force_are_those_of_a_discrete_wedge(
    soil, rake_deg, depth, surcharge, gravity
):
    """At the library's failure plane exactly; no plane gives way to much less."""
    blade = soil, depth, radians(rake_deg), 1.2, surcharge, gravity
    beta = float(failure_angle(radians(rake_deg), soil))
    force = pushed(*blade)
    assert force == pytest.approx(trial(*blade, beta), rel=1e-3)
    first, _ = least(*blade)
    size = np.hypot(*first)
    assert size * 0.999 < np.hypot(*force) < 1.06 * size
    if gravity > 9 and rake_deg >= 45:
        assert force == pytest.approx(first, abs=0.01 * size)


def test_a_flat_blade_is_pulled_down_and_a_steep_one_lifted():
    turn = pi / 2 - SANDY_LOAM.tool_friction
    for rake in RAKES:
        up = pushed(SANDY_LOAM, 0.3, rake, 1.2, 0.0, 9.81)[1]
        assert up > 0 if rake < turn else up < 0
    sticky = replace(SANDY_LOAM, adhesion=5e3)
    drawn = pushed(sticky, 0.3, 1.0, 1.2, 0.0, 9.81) - pushed(SANDY_LOAM, 0.3, 1.0, 1.2, 0.0, 9.81)
    assert drawn[0] > 0 > drawn[1]


def test_set_wholly_against_the_motion_the_force_would_be_half_as_much_again_at_20_degrees():
    plain = replace(SANDY_LOAM, adhesion=0.0)
    ahead, up = pushed(plain, 0.3, radians(20), 1.2, 0.0, 9.81)
    assert np.hypot(ahead, up) / ahead == pytest.approx(1 / sin(radians(20 + 22)), rel=1e-9)
    assert 5e3 < up < 10e3


@pytest.mark.parametrize("soil", SOILS.values(), ids=SOILS)
def test_the_failing_soil_moves_as_it_is_said_to(soil):
    """Velocities: of the blade ahead, of the wedge up its plane, without a gap between the two."""
    for rake in RAKES:
        beta = float(failure_angle(rake, soil))
        normal, up = np.array([sin(rake), cos(rake)]), np.array([-cos(rake), sin(rake)])
        plane = np.array([cos(beta), sin(beta)])
        speed = normal[0] / (plane @ normal)
        climbs = (speed * plane - np.array([1.0, 0.0])) @ up
        blade = cut(soil, 0.3, rake, 1.2, 0.0, 9.81)
        assert blade.rise * normal[0] - up[0] == pytest.approx(climbs, rel=1e-6)
        assert climbs > 0
        assert blade.normal > abs(blade.rise) * blade.rub


@pytest.mark.parametrize("alpha", np.radians([60, 75, 90]))
@pytest.mark.parametrize("beta", np.radians([20, 25]))
def test_each_factor_is_the_wedge_under_one_pull_alone(alpha, beta):
    base = SoilParameters(1e-9, 0.0, radians(33), radians(22), 0.0)
    wide = 1e6, 0.0, 1.0  # so wide that its ends do not count; no surcharge, unit gravity
    alone = (
        trial(replace(base, density=1.0), 1.0, alpha, *wide, beta),
        trial(replace(base, cohesion=1.0), 1.0, alpha, *wide, beta),
        trial(base, 1.0, alpha, 1e6, 1.0, 1.0, beta),
    )
    forces = [np.hypot(*force) / 1e6 for force in alone]
    assert wedge(alpha, beta, base)[:3] == pytest.approx(np.array(forces), rel=1e-5)


@pytest.mark.parametrize("soil", SOILS.values(), ids=SOILS)
def test_the_soil_fails_on_the_plane_of_least_resistance(soil):
    """Of an endless blade at a depth of 0.3 m."""
    pulls = [soil.density * 9.81 * 0.3, soil.cohesion, 0.0, soil.adhesion]
    for alpha, beta in zip(RAKES, failure_angle(RAKES, soil), strict=True):
        lock = pi - alpha - soil.friction - soil.tool_friction
        everywhere = wedge(alpha, np.linspace(0.01, lock - 0.01, 4000), soil) @ pulls
        assert wedge(alpha, beta, soil) @ pulls <= everywhere.min() * (1 + 1e-9)


@pytest.mark.parametrize("phi", np.radians([20, 30, 40]))
def test_a_smooth_vertical_blade_gives_rankines_passive_pressure(phi):
    smooth = SoilParameters(friction=phi, tool_friction=1e-9, adhesion=0.0)
    K_p = tan(pi / 4 + phi / 2) ** 2
    beta = failure_angle(pi / 2, smooth)
    n_gamma, n_c, n_q, _ = wedge(pi / 2, beta, smooth)
    assert 2 * n_gamma == pytest.approx(K_p, rel=1e-6)
    assert n_q == pytest.approx(K_p, rel=1e-6)
    assert n_c == pytest.approx(2 * np.sqrt(K_p), rel=1e-6)
    assert beta == pytest.approx(pi / 4 - phi / 2, rel=1e-4)


def test_between_the_rakes_of_the_table_the_force_is_that_of_the_wedge():
    for rake in np.radians([15.5, 33.3, 60.5, 88.8, 99.4]):
        blade = STIFF_CLAY, 0.3, rake, 1.2, 2000.0, 9.81
        exact = trial(*blade, float(failure_angle(rake, STIFF_CLAY)))
        assert pushed(*blade) == pytest.approx(exact, rel=2e-3, abs=50)


def test_beyond_the_table_the_nearest_rake_counts():
    blade = 0.3, 1.2, 0.0, 9.81
    for beyond, end in ((radians(2), radians(15)), (radians(170), radians(100))):
        depth, *rest = blade
        assert cut(SANDY_LOAM, depth, beyond, *rest) == cut(SANDY_LOAM, depth, end, *rest)


def test_the_force_grows_between_linearly_and_with_the_cube_of_depth():
    depth = np.array([0.05, 0.1, 0.2, 0.4, 0.8])
    force = np.array([cut(SANDY_LOAM, d, radians(60), 1.2, 0.0, 9.81).normal for d in depth])
    order = np.diff(np.log(force)) / np.diff(np.log(depth))
    assert (order > 1).all() and (order < 3).all() and (np.diff(order) > 0).all()
    for above in (0.0, -0.1):
        assert cut(SANDY_LOAM, above, radians(60), 1.2, 0.0, 9.81) == NO_CUT


def test_the_force_acts_between_a_third_and_half_of_the_face():
    face = 0.3 / sin(radians(60))
    heavy = replace(SANDY_LOAM, cohesion=0.0)
    assert cut(heavy, 0.3, radians(60), 1e6, 0.0, 9.81).centre == pytest.approx(face / 3, rel=1e-4)
    weightless = cut(SANDY_LOAM, 0.3, radians(60), 1.2, 0.0, 1e-9).centre
    assert weightless == pytest.approx(face / 2, rel=1e-6)
    weight = pushed(heavy, 0.3, radians(60), 1e6, 0.0, 9.81)[0]
    both = pushed(SANDY_LOAM, 0.3, radians(60), 1e6, 0.0, 9.81)[0]
    mean = (weight / 3 + (both - weight) / 2) / both
    loam = cut(SANDY_LOAM, 0.3, radians(60), 1e6, 0.0, 9.81)
    assert loam.centre / face == pytest.approx(mean, rel=0.01)


def test_where_the_surface_falls_ahead_the_mean_depth_comes_near_the_wedge():
    """The depth that `digging.Digger.depth_ahead` takes, beside wedges under a falling surface."""
    for slope_deg, most in ((10, 1.4), (20, 1.6), (30, 2.0)):
        for rake_deg in (50, 60, 70):
            fall = tan(radians(slope_deg))
            exact, _ = least(SANDY_LOAM, 0.5, radians(rake_deg), 1.2, 0.0, 9.81, radians(slope_deg))
            mean = (0.5 + 0.5 * (1 - fall)) / 2
            level = pushed(SANDY_LOAM, 0.5, radians(rake_deg), 1.2, 0.0, 9.81)
            taken = pushed(SANDY_LOAM, mean, radians(rake_deg), 1.2, 0.0, 9.81)
            assert 0.8 < taken[0] / exact[0] < most
            assert taken[0] < level[0]


def test_digging_forces_are_those_of_an_excavator():
    for depth in (0.2, 0.3, 0.4):
        for rake in np.radians([60, 70, 80]):
            ahead, _ = pushed(SANDY_LOAM, depth, rake, 1.2, 3000.0, 9.81)
            assert 8e3 < ahead < 60e3


def test_bearing_capacity_has_the_textbook_factors():
    third_stronger = SoilParameters(friction=atan(1.5 * tan(radians(30))), cohesion=1500.0)
    at_surface = bearing_capacity(0.0, third_stronger, 9.81)
    at_depth = bearing_capacity(1.0, third_stronger, 9.81)
    assert at_surface / 1000.0 == pytest.approx(30.14, abs=0.01)
    assert (at_depth - at_surface) / (1600 * 9.81) == pytest.approx(18.40, abs=0.01)


def test_directions_are_unit_vectors_of_the_face():
    blade = cut(SANDY_LOAM, 0.3, radians(70), 1.2, 0.0, 9.81)
    assert blade.forward**2 + blade.upward**2 == pytest.approx(blade.normal**2 + blade.rub**2)
    assert blade.rub / blade.normal == pytest.approx(tan(SANDY_LOAM.tool_friction))
    assert blade.normal * cos(blade.rake) > blade.upward
