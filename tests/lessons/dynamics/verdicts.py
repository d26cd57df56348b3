"""What decides each verdict on the thesis's dynamics: properties, adaptors, and likely misprints.

Outside of the library stand a symbolic Lagrangian (SymPy) and Pinocchio, both built from the
machine's numbers alone, weights times lever arms, and mirror symmetry.
"""

from functools import cache
from itertools import product

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import oracles
from backhoe.arm import dynamics, integrate, kinematics
from backhoe.lessons import published
from backhoe.lessons.dynamics import printed
from backhoe.machine import BACKHOE

_RNG = np.random.default_rng(22)
_Q = _RNG.uniform(-np.pi, np.pi, (60, 4))
_DQ, _DDQ = _RNG.normal(size=(2, 60, 4))
_FORCE = _RNG.normal(scale=1e4, size=(60, 3))
_CASES = published.load("mastalli_2013_free_fall")
_START = np.radians(_CASES["start_deg"])
_LAGRANGIAN = oracles.Lagrangian()


def _lagrangian(index, q=_Q, dq=_DQ):
    """A term of the symbolic Lagrangian in each state: 0 M, 1 C dq, 2 g, 3 K, 4 U."""
    return np.array([_LAGRANGIAN.terms(*state)[index] for state in zip(q, dq, strict=True)])


@cache
def _pinocchio():
    pin = pytest.importorskip("pinocchio")
    model = oracles.pinocchio_model()
    return pin, model, model.createData()


def _close(actual, expected, digits=8):
    size = np.abs(expected).max()
    np.testing.assert_allclose(actual, expected, rtol=0, atol=10.0**-digits * size)


def _times(matrix, vector):
    return (matrix @ vector[..., None])[..., 0]


# (2.11) to (2.22), (A.1), (A.19): the equation of motion


def torques_of_pinocchio_and_what_resists_it(inverse_dynamics):
    pin, model, data = _pinocchio()
    tip = model.getFrameId("tip")
    for q, dq, ddq, force in zip(_Q, _DQ, _DDQ, _FORCE, strict=True):
        J = pin.computeFrameJacobian(model, data, q, tip, pin.LOCAL_WORLD_ALIGNED)[:3]
        resists = BACKHOE.viscous * dq + BACKHOE.coulomb * np.sign(dq) + J.T @ force
        found = inverse_dynamics(q, dq, ddq, friction=True, tip_force=force)
        _close(found, pin.rnea(model, data, q, dq, ddq) + resists)


def equation_211(q, dq, ddq, friction=True, tip_force=None, side=1):
    J = kinematics.jacobian(q)[:3]
    rubs = BACKHOE.viscous * dq + BACKHOE.coulomb * np.sign(dq)
    return equation_212(q, dq, ddq) + rubs + side * J.T @ tip_force


def equation_211_with_the_tip_on_the_wrong_side(q, dq, ddq, friction=True, tip_force=None):
    return equation_211(q, dq, ddq, friction, tip_force, side=-1)


def torques_of_pinocchio(inverse_dynamics):
    pin, model, data = _pinocchio()
    for q, dq, ddq in zip(_Q, _DQ, _DDQ, strict=True):
        _close(inverse_dynamics(q, dq, ddq), pin.rnea(model, data, q, dq, ddq), 5)


def equation_212(q, dq, ddq, gravity=1):
    M, C = dynamics.mass_matrix(q), dynamics.coriolis_matrix(q, dq)
    return M @ ddq + C @ dq + gravity * dynamics.gravity_torque(q)


def equation_212_with_gravity_on_the_wrong_side(q, dq, ddq):
    return equation_212(q, dq, ddq, gravity=-1)


def lagranges_equation(q, dq, ddq, sign=-1, h=1e-4):
    """(A.19) letter by letter: L differentiated by speeds and angles, and once more along time."""

    def slope(function, at):
        return np.array([(function(at + d) - function(at - d)) / (2 * h) for d in h * np.eye(4)])

    def momentum(q, dq):
        return slope(lambda speeds: np.subtract(*dynamics.energy(q, speeds)), dq)

    after, before = (momentum(q + s * h * dq, dq + s * h * ddq) for s in (1, -1))
    return (after - before) / (2 * h) + sign * slope(
        lambda angles: np.subtract(*dynamics.energy(angles, dq)), q
    )


def lagranges_equation_with_a_plus(q, dq, ddq):
    return lagranges_equation(q, dq, ddq, sign=1)


def accelerations_that_lagrange_answers_with_the_torques(forward_dynamics):
    tau = 1e5 * _DDQ
    ddq = np.array([forward_dynamics(*state) for state in zip(_Q, _DQ, tau, strict=True)])
    _close(_times(_lagrangian(0), ddq) + _lagrangian(1) + _lagrangian(2), tau)


def equation_222(q, dq, tau, gravity=-1):
    C_dq = dynamics.coriolis_matrix(q, dq) @ dq
    return np.linalg.solve(
        dynamics.mass_matrix(q), tau - C_dq + gravity * dynamics.gravity_torque(q)
    )


def equation_222_with_gravity_added(q, dq, tau):
    return equation_222(q, dq, tau, gravity=1)


def step_of_second_order_that_keeps_the_energy_of_a_spring(rule):
    """A linear spring has an exact solution, and the trapezoid keeps its energy to rounding."""

    def spring(t, x):
        return np.array([x[1], -x[0]])

    ends = [rule(spring, [1.0, 0.0], 1.0 / n, n).x[-1] for n in (20, 40)]
    errors = [np.abs(end - [np.cos(1), -np.sin(1)]).max() for end in ends]
    assert 3.8 < errors[0] / errors[1] < 4.2
    assert abs(np.linalg.norm(ends[0]) - 1) < 1e-9


def trapezoid_of_the_start_alone(f, x0, dt, steps):
    """(f_k + f_k) / 2 for (f_k + f_k+1) / 2."""
    return integrate.euler(f, x0, dt, steps)


# (2.13), (2.14), (A.2): the mass matrix


def turning_the_house_the_other_way_costs_the_same(mass_matrix):
    """The arm is its own image in its plane, and the image of (swing, rest) is (-swing, rest)."""
    M, image = mass_matrix(_Q), np.diag([-1.0, 1.0, 1.0, 1.0])
    kinetic, mirrored = (np.einsum("ni,nij,nj->n", v, M, v) for v in (_DQ, _DQ @ image))
    _close(mirrored, kinetic)


def entries_of_the_kinetic_energy(mass_matrix):
    rows, columns = np.array([(0, 0), (1, 1), (1, 2), (1, 3), (2, 2), (2, 3)]).T
    _close(mass_matrix(_Q)[:, rows, columns], _lagrangian(0)[:, rows, columns])


def the_first_is_never_below_the_second(sides):
    """As symmetric matrices: their difference has no negative eigenvalue in all joint space."""
    turn = np.linspace(-np.pi, np.pi, 24, endpoint=False)
    grid = np.stack(np.meshgrid([0.0], turn, turn, turn), axis=-1).reshape(-1, 4)
    larger, smaller = sides(grid)
    assert np.linalg.eigvalsh(larger - smaller).min() >= 0


def mass_matrix_and_a_positive_constant(q):
    return dynamics.mass_matrix(q), 100.0 * np.eye(4)


def a_positive_constant_and_the_mass_matrix(q):
    return 100.0 * np.eye(4), dynamics.mass_matrix(q)


# (2.15) to (2.20), (A.7) to (A.10), (A.20): Coriolis


def torque_that_the_energies_demand(coriolis_torque):
    found = np.array([coriolis_torque(*state) for state in zip(_Q, _DQ, strict=True)])
    _close(found, _lagrangian(1))


def coriolis_torque(q, dq):
    return dynamics.coriolis_matrix(q, dq) @ dq


def christoffel_forms(q):
    """C_k(q) of (A.7), shape (..., 4, 4, 4): the library's C at one joint speed after another."""
    columns = [dynamics.coriolis_matrix(q, np.broadcast_to(e, q.shape)) for e in np.eye(4)]
    return np.stack(columns, axis=-2)  # C_kj of speed i -> C_k,ij


def equation_215(q, dq):
    return np.array([dq @ C_k @ dq for C_k in christoffel_forms(q)])


def equation_215_with_half_the_forms(q, dq):
    return equation_215(q, dq) / 2


def half_the_turning_of_m(q, dq):
    """The brace below (A.20): C = Mdot / 2."""
    return np.einsum("ikj,i->kj", dynamics.mass_matrix_derivative(q), dq) / 2


def gives_the_torque_that_the_energies_demand(coriolis_matrix):
    torque_that_the_energies_demand(lambda q, dq: coriolis_matrix(q, dq) @ dq)


def two_speeds_go_in_alike(coriolis_matrix):
    """C(q, x) y is what is left of the torques of x + y and x - y, by the symbolic Lagrangian."""
    y = _DDQ
    mixed = (_lagrangian(1, dq=_DQ + y) - _lagrangian(1, dq=_DQ - y)) / 4
    found = [coriolis_matrix(q, dq) @ v for q, dq, v in zip(_Q, _DQ, y, strict=True)]
    _close(np.array(found), mixed)


def equation_a7(q, x):
    return np.array([x @ C_k for C_k in christoffel_forms(q)])


def equation_a7_with_forms_that_are_not_symmetric(q, x):
    dM = dynamics.mass_matrix_derivative(q)  # dM_kj / dq_i - dM_ij / dq_k / 2
    return np.einsum("ikj,i->kj", dM, x) - np.einsum("kij,i->kj", dM, x) / 2


def skew_from_half_the_turning_of_m(coriolis_matrix, h=1e-5):
    turning = (_lagrangian(0, _Q + h * _DQ) - _lagrangian(0, _Q - h * _DQ)) / (2 * h)
    N = turning / 2 - np.array([coriolis_matrix(*state) for state in zip(_Q, _DQ, strict=True)])
    _close(N + np.swapaxes(N, 1, 2) + turning, turning, 6)


def coriolis_matrix_without_the_half(q, dq):
    return 2 * dynamics.coriolis_matrix(q, dq)


def the_first_norm_is_at_least_the_second(sides):
    larger, smaller = sides(_Q, _DQ, _DDQ)
    assert (larger >= smaller).all()


def bound_and_coriolis_torque(q, x, y):
    most = 16 * np.abs(christoffel_forms(q)).max()  # the recipe below (A.8), over these postures
    bound = most * np.linalg.norm(x, axis=1) * np.linalg.norm(y, axis=1)
    return bound, np.linalg.norm(_times(dynamics.coriolis_matrix(q, x), y), axis=1)


def coriolis_torque_and_bound(q, x, y):
    return bound_and_coriolis_torque(q, x, y)[::-1]


def _pull_of_the_spinning_house(forms, joint):
    """The swing's speed alone, which reaches a form's first entry only, against Lagrange."""
    spin = np.zeros_like(_Q)
    spin[:, 0] = 1.0
    expected = _lagrangian(1, dq=spin)
    found = np.einsum("ni,nij,nj->n", spin, forms(_Q)[:, joint], spin)
    np.testing.assert_allclose(found, expected[:, joint], atol=1e-8 * np.abs(expected).max())


def a_steady_swing_needs_no_torque(forms):
    _pull_of_the_spinning_house(forms, 0)


def a_spinning_house_throws_the_boom_outwards(forms):
    _pull_of_the_spinning_house(forms, 1)


def a_spinning_house_throws_the_stick_outwards(forms):
    _pull_of_the_spinning_house(forms, 2)


def a_spinning_house_throws_the_bucket_outwards(forms):
    _pull_of_the_spinning_house(forms, 3)


def entries_of_a_motion_in_the_arms_plane(forms):
    """What (2.20) lists for boom, stick and bucket, with the house at rest."""
    flat = _DQ * [0, 1, 1, 1]
    found = np.einsum("ni,nkij,nj->nk", flat, forms(_Q), flat)
    _close(found[:, 1:], _lagrangian(1, dq=flat)[:, 1:])


# (2.21), (A.11): gravity


def slope_of_the_weights_heights(gravity_torque, h=1e-5):
    def heights(q):
        return _lagrangian(4, q)

    slopes = [(heights(_Q + d) - heights(_Q - d)) / (2 * h) for d in h * np.eye(4)]
    _close(gravity_torque(_Q), np.transpose(slopes), 7)


def work_along_a_way_is_the_rise_of_the_weights(gravity_torque):
    t, weight = np.polynomial.legendre.leggauss(60)
    t, weight = (t + 1) / 2, weight / 2
    for start, turn in zip(_Q[:10], _DQ[:10], strict=True):
        q = start + np.outer(np.sin(2 * t), turn)
        speed = np.outer(2 * np.cos(2 * t), turn)
        work = weight @ (gravity_torque(q) * speed).sum(axis=1)
        ends = np.array([start, start + np.sin(2.0) * turn])
        rise = np.diff(_lagrangian(4, ends, 0 * ends))[0]
        assert abs(work - rise) < 1e-3


def gravity_torque_that_pulls(q):
    return -dynamics.gravity_torque(q)


# tau_0 and the signs of Table A.1


def _weights_at_their_lever_arms(offsets_deg):
    """g at the start of the cases, for offsets of stick and bucket (..., 4) [deg], by hand."""
    stick, stick_com, _, bucket_com = np.moveaxis(np.radians(offsets_deg), -1, 0)
    (_, boom_at, stick_at, bucket_at), (bo, st, bu) = _START, BACKHOE.links
    elbow = boom_at + bo.angle_offset
    pin = elbow + stick_at + stick
    g4 = bu.mass * bu.com_radius * np.cos(pin + bucket_at + bucket_com)
    g3 = g4 + bu.mass * st.length * np.cos(pin)
    g3 = g3 + st.mass * st.com_radius * np.cos(elbow + stick_at + stick_com)
    g2 = g3 + (st.mass + bu.mass) * bo.length * np.cos(elbow)
    g2 = g2 + bo.mass * bo.com_radius * np.cos(boom_at + bo.com_angle)
    return BACKHOE.gravity * np.stack((0 * g2, g2, g3, g4), axis=-1)


def _all_readings():
    angles = published.load("mastalli_2013_table_a2")["angles_deg"]
    sizes = [angles[name] for name in ("theta_3", "theta_cm3", "theta_4", "theta_cm4")]
    return np.array(list(product(*([s, -s, s - 90, -s - 90] for s in sizes))))


def torque_of_one_of_the_256_readings(torque):
    half_a_digit = np.array([1.0, 50.0, 50.0, 5.0])
    misses = np.abs(_weights_at_their_lever_arms(_all_readings()) - torque)
    assert (misses <= half_a_digit).all(axis=1).any()


GRAVITY_TORQUE_AT_THE_START = dynamics.gravity_torque(_START)


def arm_that_weighs_what_tau_0_says(offsets):
    """Within 0.1 kN m, and g3 - g4, the stick's share, within the rounding of its two figures."""
    torque, tau_0 = _weights_at_their_lever_arms(offsets()), _CASES["gravity_torque"]
    assert np.abs(np.subtract(torque, tau_0)).max() < 100
    assert abs(torque[2] - torque[3] - (tau_0[2] - tau_0[3])) <= 55


def offsets_of_the_course():
    _, stick, bucket = BACKHOE.links
    return np.degrees([stick.angle_offset, stick.com_angle, bucket.angle_offset, bucket.com_angle])


def offsets_as_printed():
    angles = published.load("mastalli_2013_table_a2")["angles_deg"]
    rows = {row["link"]: row for row in published.load("mastalli_2013_table_a1")["rows"]}
    turns = [rows[link]["constant_deg"] for link in (3, 3, 4, 4)]
    return np.add(turns, [angles[k] for k in ("theta_3", "theta_cm3", "theta_4", "theta_cm4")])


# The three cases of section 2.3.1: what the thesis says of each, against Pinocchio


def _fall(case, accelerations, seconds=1.0):
    """The state (8,) at the end of a case, by SciPy."""
    torque = np.array(_CASES[f"case_{case}"]["torque"])

    def rate(_, x):
        return np.concatenate([x[4:], accelerations(x[:4], x[4:], torque)])

    start = np.concatenate([_START, np.zeros(4)])
    return solve_ivp(rate, (0, seconds), start, rtol=1e-8, atol=1e-8).y[:, -1]


def _by_pinocchio(q, dq, tau):
    pin, model, data = _pinocchio()
    return pin.aba(model, data, q, dq, tau)


def _tip(q):
    pin, model, data = _pinocchio()
    pin.framesForwardKinematics(model, data, q)
    return data.oMf[model.getFrameId("tip")].translation.copy()


def way_of_the_teeth_in_case_1(falls):
    assert (_tip(_fall(1, _by_pinocchio)[:4])[2] < _tip(_START)[2]) == falls()


def falls_in_the_library():
    q = np.array([_START, _fall(1, dynamics.forward_dynamics)[:4]])
    before, after = kinematics.forward_kinematics(q)[:, 2, 3]
    return after < before


def the_arm_falls():
    return True


def the_arm_rises():
    return False


def direction_in_which_case_1_does_not_move(normal):
    move = _tip(_fall(1, _by_pinocchio)[:4]) - _tip(_START)
    assert abs(move @ normal()) < 1e-6


def normal_to_the_fall():
    q = np.array([_START, _fall(1, dynamics.forward_dynamics)[:4]])
    ways = np.diff(kinematics.link_transforms(q)[:, 1:, :3, 3], axis=0)[0]
    return np.linalg.svd(ways)[2][-1]


def normal_to_the_plane_xz():
    return np.array([0.0, 1.0, 0.0])


def change_of_the_stick_by_the_torque_on_the_turret(degrees):
    sticks = [_fall(case, _by_pinocchio)[2] for case in (1, 2)]
    assert abs(np.degrees(sticks[1] - sticks[0]) - degrees()) < 0.1


def change_of_the_stick_in_the_library():
    sticks = [_fall(case, dynamics.forward_dynamics)[2] for case in (1, 2)]
    return np.degrees(sticks[1] - sticks[0])


def the_form_of_the_fall_is_kept():
    return 0.0


def speed_of_the_boom_after_five_seconds_of_case_3(speed):
    assert abs(_fall(3, _by_pinocchio, 5.0)[5] - speed()) < 0.1


def speed_of_the_boom_in_the_library():
    return _fall(3, dynamics.forward_dynamics, 5.0)[5]


def the_boom_settles():
    return 0.0


def share_of_the_sticks_turn_that_needs_coriolis(share):
    def without(q, dq, tau):
        return _by_pinocchio(q, 0 * dq, tau)

    turns = [_fall(1, model)[2] - _START[2] for model in (_by_pinocchio, without)]
    assert abs(1 - turns[1] / turns[0] - share()) < 0.01


def share_in_the_library():
    def without(q, dq, tau):
        return dynamics.forward_dynamics(q, 0 * dq, tau)

    turns = [_fall(1, model)[2] - _START[2] for model in (dynamics.forward_dynamics, without)]
    return 1 - turns[1] / turns[0]


def the_chain_is_owed_to_coriolis():
    return 1.0


def falls_with_the_energy_that_the_torques_give_it(accelerations):
    x = _fall(1, accelerations)
    *_, kinetic, potential = _LAGRANGIAN.terms(x[:4], x[4:])
    *_, before = _LAGRANGIAN.terms(_START, np.zeros(4))
    work = np.array(_CASES["case_1"]["torque"]) @ (x[:4] - _START)
    assert abs(kinetic + potential - before - work) < 1e-4 * kinetic


def printed_forward_dynamics(q, dq, tau):
    push = tau - printed.coriolis_vector(q, dq) - printed.gravity_torque(q)
    return np.linalg.solve(printed.mass_matrix(q), push)
