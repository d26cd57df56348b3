from dataclasses import fields, replace
from math import atan, pi, radians, tan

import numpy as np
import pytest

from backhoe.simulation.soil.earthmoving import (
    LOAM,
    SOURCES,
    SoilParameters,
    bearing_capacity,
    cutting_factors,
    failure_angle,
    wedge,
)

RAKES = np.radians(np.arange(15.0, 100.1, 5.0))


def balance(alpha, beta, soil, loads):
    """Force of a blade on its wedge at failure, from the balance of forces in the plane (x, up).

    The blade moves in +x and leans back by its rake, the wedge lies on the failure plane ahead of
    it. Unknown are the sizes of the blade's force, delta from its normal, and of the plane's
    reaction, phi from its own; friction acts against the wedge's way up along both.
    """
    up_blade = np.array([-np.cos(alpha), np.sin(alpha)])
    up_plane = np.array([np.cos(beta), np.sin(beta)])
    from_blade = np.array([up_blade[1], -up_blade[0]])
    from_plane = np.array([-up_plane[1], up_plane[0]])
    blade = from_blade * np.cos(soil.tool_friction) - up_blade * np.sin(soil.tool_friction)
    plane = from_plane * np.cos(soil.friction) - up_plane * np.sin(soil.friction)
    force, _ = np.linalg.solve(np.column_stack([blade, plane]), -loads(up_blade, up_plane))
    return force


@pytest.mark.parametrize("alpha", np.radians([30, 60, 90]))
@pytest.mark.parametrize("beta", np.radians([15, 25]))
def test_the_factors_balance_the_forces_on_the_wedge(alpha, beta):
    top = 1 / np.tan(alpha) + 1 / np.tan(beta)
    loads = (
        lambda blade, plane: np.array([0.0, -top / 2]),
        lambda blade, plane: -plane / np.sin(beta),
        lambda blade, plane: np.array([0.0, -top]),
        lambda blade, plane: -blade / np.sin(alpha),
    )
    forces = [balance(alpha, beta, LOAM, load) for load in loads]
    assert wedge(alpha, beta, LOAM) == pytest.approx(np.array(forces), rel=1e-9)


def test_the_soil_fails_on_the_plane_of_least_resistance():
    beta, step = failure_angle(RAKES, LOAM), 1e-4
    at, above, below = (wedge(RAKES, beta + s, LOAM)[..., 0] for s in (0, step, -step))
    assert np.abs((above - below) / (2 * step)).max() < 1e-3 * at.max()
    assert (above > at).all() and (below > at).all()
    for alpha, n_gamma in zip(RAKES, at, strict=True):
        lock = pi - alpha - LOAM.friction - LOAM.tool_friction
        everywhere = wedge(alpha, np.linspace(0.01, lock - 0.01, 4000), LOAM)[..., 0]
        assert n_gamma <= everywhere.min() + 1e-9


@pytest.mark.parametrize("phi", np.radians([20, 30, 40]))
def test_a_smooth_vertical_blade_gives_rankines_passive_pressure(phi):
    smooth = SoilParameters(friction=phi, tool_friction=1e-9, adhesion=0.0)
    K_p = tan(pi / 4 + phi / 2) ** 2
    n_gamma, n_c, n_q, _ = cutting_factors(pi / 2, smooth)
    assert 2 * n_gamma == pytest.approx(K_p, rel=1e-6)
    assert n_q == pytest.approx(K_p, rel=1e-6)
    assert n_c == pytest.approx(2 * np.sqrt(K_p), rel=1e-6)
    assert failure_angle(pi / 2, smooth) == pytest.approx(pi / 4 - phi / 2, rel=1e-4)


def test_the_table_agrees_with_the_solution():
    for rake in np.radians([15.0, 33.3, 60.5, 88.8, 100.0]):
        n_gamma, n_c, n_q, n_a = cutting_factors(rake, LOAM)
        d, q, w, g = 0.3, 2000.0, 1.2, 9.81
        force = LOAM.density * g * d**2 * n_gamma + LOAM.cohesion * d * n_c + q * d * n_q
        force = (force + LOAM.adhesion * d * n_a) * w
        assert LOAM.cutting_force(d, rake, w, q, g) == pytest.approx(force, rel=1e-3)


def test_the_cutting_force_grows_between_linearly_and_with_the_square_of_depth():
    depth = np.array([0.05, 0.1, 0.2, 0.4, 0.8])
    force = np.array([LOAM.cutting_force(d, radians(60), 1.2, 0.0, 9.81) for d in depth])
    order = np.diff(np.log(force)) / np.diff(np.log(depth))
    assert (order > 1).all() and (order < 2).all() and (np.diff(order) > 0).all()
    assert LOAM.cutting_force(0.0, radians(60), 1.2, 0.0, 9.81) == 0
    assert LOAM.cutting_force(-0.1, radians(60), 1.2, 0.0, 9.81) == 0


def test_digging_forces_are_those_of_an_excavator():
    for depth in (0.2, 0.3, 0.4):
        for rake in np.radians([70, 80, 90]):
            force = LOAM.cutting_force(depth, rake, 1.2, 3000.0, 9.81)
            assert 10e3 < force < 60e3


def test_bearing_capacity_has_the_textbook_factors():
    third_stronger = SoilParameters(friction=atan(1.5 * tan(radians(30))), cohesion=1500.0)
    at_surface = bearing_capacity(0.0, third_stronger, 9.81)
    at_depth = bearing_capacity(1.0, third_stronger, 9.81)
    assert at_surface / 1000.0 == pytest.approx(30.14, abs=0.01)
    assert (at_depth - at_surface) / (1600 * 9.81) == pytest.approx(18.40, abs=0.01)


def test_every_parameter_has_a_unit_and_a_source():
    assert set(SOURCES) == {field.name for field in fields(SoilParameters)}
    assert all(unit and source for unit, source in SOURCES.values())


@pytest.mark.parametrize(
    "change, message",
    [
        ({"density": 0.0}, "soil density must be one number above 0"),
        ({"density": "heavy"}, "soil density must be one number above 0"),
        ({"cohesion": -1.0}, "soil cohesion must be one number at least 0"),
        ({"friction": float("nan")}, "soil friction must be one number above 0"),
        ({"repose": radians(50)}, "soil repose must be one number below 0.785"),
        ({"tool_friction": radians(40)}, "tool_friction must not exceed friction"),
        ({"spill_rate": 0.0}, "soil spill_rate must be one number above 0"),
    ],
)
def test_bad_parameters_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        replace(LOAM, **change)


def test_a_rake_outside_the_theory_is_refused():
    with pytest.raises(ValueError, match=r"15 to 100 degrees, got 120\.0"):
        cutting_factors(radians(120), LOAM)
