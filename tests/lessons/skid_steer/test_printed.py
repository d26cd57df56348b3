"""Chapter 2's wrong formulas, judged by what any right one must satisfy."""

import numpy as np
import pytest

from backhoe.lessons.skid_steer import printed
from backhoe.vehicle import motor, skid_steer
from backhoe.vehicle.skid_steer import HUSKY, PROVENANCE, replace
from units import UNITS, in_units

OTHER = {"kg": 3.0, "m": 0.4, "s": 1.7}


def converts_as(quantity, exponents):
    """Whether quantity(vehicle, length unit, time unit) scales as kg^a m^b s^c."""
    a, b, c = exponents
    here = quantity(HUSKY, 1.0, 1.0)
    there = quantity(in_units(HUSKY, **OTHER), OTHER["m"], OTHER["s"])
    factor = OTHER["kg"] ** a * OTHER["m"] ** b * OTHER["s"] ** c
    return here == pytest.approx(there * factor, rel=1e-9)


FORCE, MOMENT = (1, 1, -2), (1, 2, -2)


def test_213b_as_printed_is_a_force_and_repaired_a_moment():
    def as_printed(vehicle, _, s):
        return float(printed.moment_213b(0.5 * s, vehicle))

    def repaired(vehicle, _, s):
        return skid_steer.rates(vehicle).drag_omega * vehicle.inertia * 0.5 * s

    assert converts_as(as_printed, FORCE)
    assert not converts_as(as_printed, MOMENT)
    assert converts_as(repaired, MOMENT)


def test_213b_repaired_is_what_four_wheels_add_up_to():
    omega = 0.5
    slip = skid_steer.contact_velocity([0.0, 0.0, omega])[:, 1]
    force = HUSKY.loads * HUSKY.lateral * slip
    moment = HUSKY.positions[:, 0] @ force
    assert skid_steer.rates().drag_omega * HUSKY.inertia * omega == pytest.approx(moment)
    assert printed.moment_213b(omega) != pytest.approx(moment, rel=0.1)


def test_214_as_printed_is_no_torque():
    def left(vehicle, m, s):
        u = np.array([1.0 / m * s, 0.5 * s])
        return float(printed.torque_214(u, 0.3 / m * s, 0.1 * s, vehicle)[0])

    assert not converts_as(left, MOMENT)
    assert converts_as(left, (1, 3, -2))  # N m^2: one length too many


def test_214_lacks_the_division_by_the_wheel_radius():
    u, v, omega = np.array([1.0, 0.5]), 0.3, 0.1
    wheels = skid_steer.wheel_speeds([v, omega])
    wanted = skid_steer.wheel_speeds(u)
    right = HUSKY.speed_gain * (wanted - wheels)
    assert np.array(printed.torque_214(u, v, omega)) / HUSKY.wheel_radius == pytest.approx(right)


def test_216_as_printed_lacks_a_wheel_a_side_and_one_radius():
    free = replace(HUSKY, rolling=0.0, lateral=0.0)
    ratio = (
        skid_steer.state_space(free).A[[1, 3], [1, 3]]
        / printed.state_space_216(free).A[[1, 3], [1, 3]]
    )
    assert ratio == pytest.approx([2 / HUSKY.wheel_radius] * 2)


def test_41_without_inductance_is_the_first_order_motor():
    m, load = replace(motor.WHEELCHAIR, gear=1.0, inductance=1e-15), motor.Load(0.04, 0.002)
    system = motor.first_order(m, load)
    slow = 1 + system.time_constant * 7.0j
    found = printed.transfer_41(7.0j, m, load)
    assert found == pytest.approx((system.gain / slow, -system.torque_gain / slow), rel=1e-9)


def test_the_scaling_of_units_covers_every_field():
    assert set(UNITS) <= set(PROVENANCE)
