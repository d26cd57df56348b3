"""Dynamics: the closed forms against other libraries, a symbolic Lagrangian and the energies."""

import sys
from functools import partial

import numpy as np
import pytest

import oracles
from backhoe.arm import dynamics, kinematics
from backhoe.arm.dynamics import postures
from backhoe.machine import BACKHOE, replace

VARIANT = replace(
    BACKHOE,
    gravity=1.62,
    swing=replace(BACKHOE.swing, offset=0.3, mass=5000.0, com_angle=2.5),
    stick=replace(BACKHOE.stick, length=2.5, mass=1400.0),
    bucket=replace(BACKHOE.bucket, mass=1800.0, com_radius=0.7, com_angle=-1.0),
)
MACHINES = pytest.mark.parametrize("machine", [BACKHOE, VARIANT], ids=["backhoe", "variant"])
CASE_1 = np.radians([0.0, 0.0, -10.0, 0.0])


@pytest.fixture
def rng():
    return np.random.default_rng(5)


@pytest.fixture
def states(rng):
    """q, dq and ddq over the whole joint space, limits ignored."""
    q = rng.uniform(-np.pi, np.pi, (200, 4))
    return q, rng.uniform(-2, 2, (200, 4)), rng.uniform(-3, 3, (200, 4))


@pytest.fixture(scope="module")
def bullet(tmp_path_factory):
    pybullet = pytest.importorskip("pybullet")
    path = tmp_path_factory.mktemp("urdf") / "arm.urdf"
    path.write_text(oracles.urdf())
    client = pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -BACKHOE.gravity, physicsClientId=client)
    body = pybullet.loadURDF(
        str(path),
        useFixedBase=True,
        flags=pybullet.URDF_USE_INERTIA_FROM_FILE,
        physicsClientId=client,
    )
    yield pybullet, body, client
    pybullet.disconnect(client)


def times(matrix, vector):
    return (matrix @ vector[..., None])[..., 0]


def central_difference(function, x, step=1e-5):
    """Derivative by each component of x, first axis the component."""
    return np.array(
        [(function(x + step * e) - function(x - step * e)) / (2 * step) for e in np.eye(x.size)]
    )


def close(actual, expected, digits=13):
    """Equal to so many digits of the largest entry."""
    np.testing.assert_allclose(
        actual, expected, rtol=0, atol=10.0**-digits * np.abs(expected).max()
    )


# Against other derivations of the same dynamics


@MACHINES
def test_terms_are_those_of_a_symbolic_lagrangian(states, machine):
    pytest.importorskip("sympy")
    lagrangian = oracles.Lagrangian(machine)
    for q, dq, _ in zip(*states, strict=True):
        M, C_dq, g, kinetic, potential = lagrangian.terms(q, dq)
        close(dynamics.mass_matrix(q, machine), M)
        close(dynamics.coriolis_matrix(q, dq, machine) @ dq, C_dq, 12)
        close(dynamics.gravity_torque(q, machine), g)
        close(dynamics.energy(q, dq, machine), (kinetic, potential))


@MACHINES
def test_terms_are_those_of_pinocchio(states, machine):
    pin = pytest.importorskip("pinocchio")
    model = oracles.pinocchio_model(machine)
    data = model.createData()
    for q, dq, ddq in zip(*states, strict=True):
        M = pin.crba(model, data, q)
        close(dynamics.mass_matrix(q, machine), np.triu(M) + np.triu(M, 1).T)
        close(
            dynamics.gravity_torque(q, machine), pin.computeGeneralizedGravity(model, data, q), 12
        )
        close(
            dynamics.inverse_dynamics(q, dq, ddq, machine=machine),
            pin.rnea(model, data, q, dq, ddq),
        )
        close(
            dynamics.coriolis_matrix(q, dq, machine) @ dq,
            pin.computeCoriolisMatrix(model, data, q, dq) @ dq,
            12,
        )


def test_terms_are_those_of_pybullet(bullet, states):
    pybullet, body, client = bullet
    for q, dq, ddq in zip(*states, strict=True):
        M = pybullet.calculateMassMatrix(body, q.tolist(), physicsClientId=client)
        close(dynamics.mass_matrix(q), np.array(M))
        tau = pybullet.calculateInverseDynamics(
            body, q.tolist(), dq.tolist(), ddq.tolist(), physicsClientId=client
        )
        close(dynamics.inverse_dynamics(q, dq, ddq), np.array(tau))


@MACHINES
def test_mass_matrix_is_the_sum_of_the_links_energies_by_their_jacobians(states, machine):
    expected = np.zeros((200, 4, 4))
    bodies = zip(
        ("swing_com", "boom_com", "stick_com", "bucket_com"),
        (machine.swing, *machine.links),
        strict=True,
    )
    for frame, body in bodies:
        J = kinematics.jacobian(states[0], frame, machine)
        weights = np.array([body.mass] * 3 + [body.inertia] * 3)
        expected += np.swapaxes(J, -1, -2) @ (weights[:, None] * J)
    close(dynamics.mass_matrix(states[0], machine), expected)


# Properties


@MACHINES
def test_mass_matrix_is_symmetric_and_positive_definite_over_the_joint_space(rng, machine):
    turn = np.linspace(-np.pi, np.pi, 36, endpoint=False)
    grid = np.stack(np.meshgrid([0.0], turn, turn, turn, indexing="ij"), axis=-1).reshape(-1, 4)
    for q in (grid, rng.uniform(-np.pi, np.pi, (20_000, 4))):
        M = dynamics.mass_matrix(q, machine)
        np.testing.assert_array_equal(M, np.swapaxes(M, -1, -2))
        assert np.linalg.eigvalsh(M).min() > machine.bucket.inertia / 10


def test_mass_matrix_does_not_depend_on_the_swing(states):
    q = states[0]
    turned = q + np.array([1.0, 0, 0, 0])
    np.testing.assert_array_equal(dynamics.mass_matrix(q), dynamics.mass_matrix(turned))


@MACHINES
def test_mass_matrix_derivative_is_the_slope_of_the_mass_matrix(states, machine):
    for q in states[0][:50]:
        slope = central_difference(partial(dynamics.mass_matrix, machine=machine), q)
        close(dynamics.mass_matrix_derivative(q, machine), slope, 8)


@MACHINES
def test_mdot_less_twice_c_is_skew(states, machine):
    q, dq, _ = states
    dM_dt = np.einsum("nkij,nk->nij", dynamics.mass_matrix_derivative(q, machine), dq)
    N = dM_dt - 2 * dynamics.coriolis_matrix(q, dq, machine)
    close(N + np.swapaxes(N, -1, -2) + dM_dt, dM_dt)
    assert np.abs(N).max() > 1e4


def test_coriolis_matrix_is_made_of_the_christoffel_symbols(states):
    q, dq, _ = states
    dM = dynamics.mass_matrix_derivative(q[0])
    C = np.zeros((4, 4))
    for k in range(4):
        for j in range(4):
            for i in range(4):
                c_kij = (dM[i, k, j] + dM[j, k, i] - dM[k, i, j]) / 2
                C[k, j] += c_kij * dq[0, i]
    close(dynamics.coriolis_matrix(q[0], dq[0]), C)


def test_coriolis_torque_is_what_the_energies_demand(states):
    """C dq = d/dt (dT/d(dq)) - dT/dq at ddq = 0, by finite differences of the kinetic energy."""
    for q, dq in zip(*states[:2], strict=True):
        h = 1e-5
        momentum_rate = (
            dynamics.mass_matrix(q + h * dq) @ dq - dynamics.mass_matrix(q - h * dq) @ dq
        ) / (2 * h)
        slope = central_difference(lambda x, dq=dq: dynamics.energy(x, dq)[0], q)
        close(dynamics.coriolis_matrix(q, dq) @ dq, momentum_rate - slope, 6)


@MACHINES
def test_gravity_torque_is_the_gradient_of_the_potential_energy(states, machine):
    for q in states[0][:50]:
        slope = central_difference(lambda x: dynamics.energy(x, np.zeros(4), machine)[1], q)
        close(dynamics.gravity_torque(q, machine), slope, 8)


@MACHINES
def test_inverse_dynamics_is_the_sum_of_its_terms(states, machine):
    q, dq, ddq = states
    tau = (
        times(dynamics.mass_matrix(q, machine), ddq)
        + times(dynamics.coriolis_matrix(q, dq, machine), dq)
        + dynamics.gravity_torque(q, machine)
    )
    close(dynamics.inverse_dynamics(q, dq, ddq, machine=machine), tau)


@pytest.mark.parametrize(
    "friction", [None, True, lambda dq: 300 * dq], ids=["none", "own", "given"]
)
@pytest.mark.parametrize("tip_force", [None, [2e4, -1e3, -3e4]], ids=["free", "digging"])
def test_forward_dynamics_undoes_inverse_dynamics(states, friction, tip_force):
    q, dq, ddq = states
    tau = dynamics.inverse_dynamics(q, dq, ddq, friction, tip_force)
    np.testing.assert_allclose(
        dynamics.forward_dynamics(q, dq, tau, friction, tip_force), ddq, atol=1e-11
    )


def test_power_of_the_torques_becomes_energy(states):
    q, dq, ddq = states
    h = 1e-6

    def total(sign):
        moved = q + sign * h * dq + h * h / 2 * ddq
        return np.add(*dynamics.energy(moved, dq + sign * h * ddq))

    power = (dynamics.inverse_dynamics(q, dq, ddq) * dq).sum(axis=-1)
    close((total(1) - total(-1)) / (2 * h), power, 6)


def test_energy_is_kept_without_torque():
    from scipy.integrate import solve_ivp

    def f(t, x):
        return np.r_[x[4:], dynamics.forward_dynamics(x[:4], x[4:], np.zeros(4))]

    x0 = np.r_[CASE_1, 0.8, 0.1, -0.2, 0.3]
    x = solve_ivp(f, (0, 3), x0, method="DOP853", rtol=1e-12, atol=1e-12).y.T
    energy = np.add(*dynamics.energy(x[:, :4], x[:, 4:]))
    kinetic = dynamics.energy(x[:, :4], x[:, 4:])[0]
    assert np.ptp(kinetic) > 1e5
    assert np.ptp(energy) < 1e-8 * np.ptp(kinetic)
    momentum = (dynamics.mass_matrix(x[:, :4])[:, 0] * x[:, 4:]).sum(axis=1)
    np.testing.assert_allclose(momentum, momentum[0], rtol=1e-8)


# What the thesis prints, and what is right


def test_gravity_torque_at_the_start_of_case_1_comes_near_the_printed_one():
    g = dynamics.gravity_torque(CASE_1) / 1e3
    np.testing.assert_allclose(g, [0, 152.33, -2.32, -4.18], atol=0.005)
    np.testing.assert_allclose(g, [0, 152.4, -2.4, -4.27], atol=0.1)


@pytest.mark.parametrize(
    ("tau", "q_deg", "dq_deg"),
    [
        ([0, 114.3e3, -1.8e3, -3.2e3], [0, -16.886, 5.973, -15.770], [0, -35.39, 48.00, -49.28]),
        ([500e3, 114.3e3, -1.8e3, -3.2e3], [122, None, 105, None], [238, None, None, None]),
        ([0, 155e3, -1.8e3, -3.2e3], [0, 2.2, None, None], [0, None, None, None]),
    ],
    ids=["case 1", "case 2", "case 3"],
)
def test_free_fall_after_one_second(tau, q_deg, dq_deg):
    from scipy.integrate import solve_ivp

    def f(t, x):
        return np.r_[x[4:], dynamics.forward_dynamics(x[:4], x[4:], np.array(tau))]

    x0 = np.r_[CASE_1, np.zeros(4)]
    end = np.degrees(solve_ivp(f, (0, 1), x0, method="DOP853", rtol=1e-11, atol=1e-11).y[:, -1])
    for reached, audited in zip(end, q_deg + dq_deg, strict=True):
        if audited is not None:
            half_a_digit = 0.5 * 10.0 ** -len(f"{audited}".partition(".")[2])
            assert reached == pytest.approx(audited, abs=max(half_a_digit, 5e-4) * 1.01)


# Friction and the tip's force


def test_friction_torque_is_viscous_plus_coulomb():
    dq = np.array([0.5, -0.2, 0.0, 1e-9])
    viscous, coulomb = BACKHOE.viscous, BACKHOE.coulomb
    expected = viscous * dq + coulomb * [1, -1, 0, 1]
    np.testing.assert_allclose(dynamics.friction_torque(dq), expected)


def test_smooth_friction_approaches_the_jump_away_from_rest(rng):
    dq = rng.choice([-1, 1], (50, 4)) * rng.uniform(0.1, 1, (50, 4))
    smooth = dynamics.friction_torque(dq, smoothing=0.005)
    np.testing.assert_allclose(smooth, dynamics.friction_torque(dq), rtol=1e-12)
    near = dynamics.friction_torque(np.full(4, 1e-6), smoothing=0.005)
    assert (near < BACKHOE.coulomb * 1e-3).all()


def test_friction_always_takes_energy(rng):
    dq = rng.normal(size=(500, 4))
    for smoothing in (None, 0.05):
        assert (dq * dynamics.friction_torque(dq, smoothing=smoothing) > 0).all()


def test_friction_and_tip_force_add(states):
    q, dq, ddq = states
    force = [1e4, -2e4, 3e4]
    free, rubbed, pushed, both = (
        dynamics.inverse_dynamics(q, dq, ddq, friction, tip)
        for friction, tip in ((None, None), (True, None), (None, force), (True, force))
    )
    np.testing.assert_allclose(both - free, (rubbed - free) + (pushed - free), atol=1e-7)


def test_friction_is_off_unless_passed_and_takes_the_machines_when_true(states):
    q, dq, ddq = states
    free = dynamics.inverse_dynamics(q, dq, ddq)
    own = dynamics.inverse_dynamics(q, dq, ddq, friction=True)
    np.testing.assert_allclose(own - free, dynamics.friction_torque(dq), atol=1e-8)
    smooth = partial(dynamics.friction_torque, smoothing=0.01)
    given = dynamics.inverse_dynamics(q, dq, ddq, friction=smooth)
    np.testing.assert_allclose(given - free, smooth(dq), atol=1e-8)


def test_tip_force_is_paid_for_in_power(states, rng):
    q, dq, ddq = states
    force = rng.normal(scale=1e4, size=(200, 3))
    extra = dynamics.inverse_dynamics(q, dq, ddq, tip_force=force) - dynamics.inverse_dynamics(
        q, dq, ddq
    )
    h = 1e-6
    velocity = (
        kinematics.forward_kinematics(q + h * dq) - kinematics.forward_kinematics(q - h * dq)
    )[:, :3, 3] / (2 * h)
    close((extra * dq).sum(axis=1), (force * velocity).sum(axis=1), 7)


def test_ground_that_carries_the_tip_relieves_the_boom():
    """A tip that presses down with h_e is pushed up by the ground."""
    q = [-np.pi / 2, 0.2, -0.3, 0.5]
    rest = np.zeros(4)
    pressing = dynamics.inverse_dynamics(q, rest, rest, tip_force=[0, 0, -1e4])
    assert pressing[1] < dynamics.inverse_dynamics(q, rest, rest)[1]


def test_load_in_the_bucket_is_mass_at_its_centre(states):
    payload = 900.0
    loaded = replace(BACKHOE, bucket=replace(BACKHOE.bucket, mass=BACKHOE.bucket.mass + payload))
    q, _, _ = states
    J = kinematics.jacobian(q, "bucket_com")[:, :3]
    extra = dynamics.mass_matrix(q, loaded) - dynamics.mass_matrix(q)
    close(extra, payload * np.swapaxes(J, -1, -2) @ J, 10)


# Many postures


FUNCTIONS = {
    "mass_matrix": lambda q, dq, ddq: dynamics.mass_matrix(q),
    "mass_matrix_derivative": lambda q, dq, ddq: dynamics.mass_matrix_derivative(q),
    "coriolis_matrix": lambda q, dq, ddq: dynamics.coriolis_matrix(q, dq),
    "gravity_torque": lambda q, dq, ddq: dynamics.gravity_torque(q),
    "inverse_dynamics": dynamics.inverse_dynamics,
    "forward_dynamics": lambda q, dq, ddq: dynamics.forward_dynamics(q, dq, 1e5 * ddq),
    "energy": lambda q, dq, ddq: np.stack(dynamics.energy(q, dq), axis=-1),
    "friction_torque": lambda q, dq, ddq: dynamics.friction_torque(dq),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_many_states_give_what_each_gives_alone(states, name):
    function = FUNCTIONS[name]
    grid = [part[:24].reshape(2, 3, 4, 4) for part in states]
    together = function(*grid)
    flat = [part.reshape(-1, 4) for part in grid]
    alone = np.array([function(*state) for state in zip(*flat, strict=True)])
    close(together.reshape(alone.shape), alone, 14)


def test_one_posture_goes_with_many_speeds(states):
    q, dq, ddq = states[0][0], states[1], states[2][0]
    expected = dynamics.inverse_dynamics(np.tile(q, (200, 1)), dq, np.tile(ddq, (200, 1)))
    np.testing.assert_array_equal(dynamics.inverse_dynamics(q, dq, ddq), expected)
    assert dynamics.energy(q, dq)[1].shape == (200,)


def test_no_states_give_no_results():
    none = np.zeros((0, 4))
    assert dynamics.mass_matrix(none).shape == (0, 4, 4)
    assert dynamics.inverse_dynamics(none, none, none).shape == (0, 4)


def test_inputs_stay_as_they_were(states):
    before = [part.copy() for part in states]
    dynamics.inverse_dynamics(*states, friction=True, tip_force=[1, 2, 3])
    dynamics.coriolis_matrix(*states[:2])
    for part, was in zip(states, before, strict=True):
        np.testing.assert_array_equal(part, was)


@pytest.mark.parametrize("numba", [True, False], ids=["compiled", "without numba"])
def test_very_many_states_give_the_same_numbers(rng, monkeypatch, numba):
    if numba:
        pytest.importorskip("numba")
    else:
        monkeypatch.setitem(sys.modules, "backhoe.arm.dynamics.engine", None)
        monkeypatch.delattr("backhoe.arm.dynamics.engine", raising=False)
    shape = (5, postures.MANY // 5, 4)
    q, dq, ddq = rng.uniform(-2, 2, (3, *shape))
    q.flags.writeable = False
    M, tau = dynamics.mass_matrix(q), dynamics.inverse_dynamics(q, dq, ddq)
    assert M.shape == (*shape, 4)
    some = np.s_[:, ::5000]
    close(M[some], dynamics.mass_matrix(q[some]), 14)
    close(tau[some], dynamics.inverse_dynamics(q[some], dq[some], ddq[some]), 14)
    if numba:
        assert "backhoe.arm.dynamics.engine" in sys.modules


# Bad input


ZERO = np.zeros(4)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: dynamics.mass_matrix(np.zeros((2, 3))), r"q must end in 4 joints .* \(2, 3\)"),
        (lambda: dynamics.mass_matrix([0, np.nan, 0, 0]), "q must be finite, got nan"),
        (lambda: dynamics.mass_matrix("posture"), "q must be numbers, got 'posture'"),
        (lambda: dynamics.gravity_torque(0.0), r"got shape \(\)"),
        (lambda: dynamics.coriolis_matrix(ZERO, np.zeros(5)), r"dq must end in 4 .* \(5,\)"),
        (lambda: dynamics.inverse_dynamics(ZERO, ZERO, [0, 0, 0]), r"ddq must end in 4 joints"),
        (lambda: dynamics.forward_dynamics(ZERO, ZERO, [0, 0, 0, np.inf]), "tau must be finite"),
        (lambda: dynamics.energy(ZERO, [[1, 2]]), "dq must end in 4 joints"),
        (
            lambda: dynamics.inverse_dynamics(np.zeros((2, 4)), np.zeros((3, 4)), ZERO),
            r"the leading axes must fit each other, got shapes \(2, 4\), \(3, 4\), \(4,\)",
        ),
        (
            lambda: dynamics.coriolis_matrix(np.zeros((2, 4)), np.zeros((3, 4))),
            r"the leading axes must fit each other, got shapes \(2, 4\), \(3, 4\)",
        ),
        (
            lambda: dynamics.energy(np.zeros((2, 4)), np.zeros((3, 4))),
            r"the leading axes must fit each other, got shapes \(2, 4\), \(3, 4\)",
        ),
        (
            lambda: dynamics.inverse_dynamics(np.zeros((2, 4)), ZERO, ZERO, None, np.ones((5, 3))),
            r"the leading axes must fit each other, got shapes \(2, 4\), \(4,\), \(5, 3\)",
        ),
        (
            lambda: dynamics.inverse_dynamics(ZERO, ZERO, ZERO, tip_force=[1j, 0, 0]),
            "tip_force must be numbers",
        ),
        (
            lambda: dynamics.forward_dynamics(ZERO, ZERO, ZERO, tip_force="down"),
            "tip_force must be numbers",
        ),
        (
            lambda: dynamics.friction_torque(ZERO, smoothing=0.0),
            "smoothing must be one number above 0",
        ),
        (
            lambda: dynamics.inverse_dynamics(ZERO, ZERO, ZERO, tip_force=[1, 2]),
            "tip_force must end in 3 components",
        ),
        (
            lambda: dynamics.inverse_dynamics(ZERO, ZERO, ZERO, tip_force=[1, 2, np.nan]),
            "tip_force must be finite, got nan at index 2",
        ),
        (
            lambda: dynamics.forward_dynamics(ZERO, ZERO, ZERO, friction=lambda dq: dq[:3]),
            r"friction\(dq\) must end in 4 joints",
        ),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize("friction", ["yes", 3.0, (1.0, 2.0)])
def test_unknown_friction_is_refused(friction):
    with pytest.raises(TypeError, match="friction must be None, True or a function"):
        dynamics.forward_dynamics(ZERO, ZERO, ZERO, friction=friction)
