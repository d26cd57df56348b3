"""The linear models against finite differences and small steps of the nonlinear arm."""

import control
import numpy as np
import pytest

from backhoe.arm import closed_loop, dynamics, integrate, linearise, movement
from backhoe.arm.pid import ARM_GAINS, Gains
from backhoe.lessons import published
from backhoe.machine import BACKHOE, JOINTS, variants

Q = np.radians([20.0, 25.0, -15.0, 40.0])
PRINTED = published.load("mastalli_2013_eq_333")
THESIS = Gains(*(np.array(PRINTED[name]) for name in ("K_p", "K_i", "K_d")))


def viscous(machine=BACKHOE):
    return lambda dq: machine.viscous * dq


def plant_rate(x, u, machine, friction):
    """The nonlinear arm, with the torque beyond what holds it at Q."""
    q, dq = np.split(x, 2)
    tau = dynamics.gravity_torque(Q, machine) + u
    resistance = viscous(machine) if friction else None
    return np.r_[dq, dynamics.forward_dynamics(q, dq, tau, resistance, machine=machine)]


def controlled_rate(x, reference, gains, law):
    """xi, q, dq under the law; the integral starts from what holds the arm at Q."""
    kp, ki, kd = gains
    xi, q, dq = np.split(x, 3)
    tau = kp * (reference - q) + ki * xi - kd * dq
    tau = tau + dynamics.gravity_torque(Q if law == "pid" else q)
    return np.r_[reference - q, dq, dynamics.forward_dynamics(q, dq, tau, viscous())]


def slopes(function, x, step=1e-6):
    """Central differences, a column for each entry of x."""
    columns = []
    for k in range(len(x)):
        shift = step * np.eye(len(x))[k]
        columns.append((function(x + shift) - function(x - shift)) / (2 * step))
    return np.array(columns).T


@pytest.mark.parametrize("friction", [True, False])
@pytest.mark.parametrize("machine", [BACKHOE, variants.loaded(850.0)])
def test_plant_is_the_slope_of_the_nonlinear_arm(machine, friction):
    system = linearise.arm(Q, machine, friction=friction)
    x, u = np.r_[Q, np.zeros(4)], np.zeros(4)
    A = slopes(lambda x: plant_rate(x, u, machine, friction), x)
    B = slopes(lambda u: plant_rate(x, u, machine, friction), u, step=1.0)
    np.testing.assert_allclose(system.A, A, rtol=1e-7, atol=1e-7)
    np.testing.assert_allclose(system.B, B, rtol=1e-7, atol=1e-12)


@pytest.mark.parametrize("law", linearise.LAWS)
def test_closed_loop_is_the_slope_of_the_nonlinear_closed_loop(law):
    system = linearise.arm(Q, gains=THESIS, law=law)
    x = np.r_[np.zeros(4), Q, np.zeros(4)]
    A = slopes(lambda x: controlled_rate(x, Q, THESIS, law), x)
    B = slopes(lambda reference: controlled_rate(x, reference, THESIS, law), Q)
    np.testing.assert_allclose(system.A, A, rtol=1e-6, atol=1e-4)
    np.testing.assert_allclose(system.B, B, rtol=1e-6, atol=1e-4)


def test_step_response_is_that_of_a_small_step_in_the_simulation():
    """Half the step halves the difference: what remains is of second order."""
    system = linearise.arm(Q, gains=ARM_GAINS)
    t = np.arange(0, 2.001, 0.001)
    response = control.step_response(system, t, squeeze=False).outputs[:, 1]
    gaps = []
    for size in (0.02, 0.01):
        x0 = np.r_[np.zeros(4), Q, np.zeros(4)]
        goal = Q + np.array([0, size, 0, 0])
        found = integrate.rk4(
            lambda t, x, goal=goal: controlled_rate(x, goal, ARM_GAINS, "pid"), x0, 1e-3, 2000
        )
        gaps.append(np.abs((found.x[:, 4:8] - Q) / size - response.T).max())
    assert gaps[1] < 0.01
    assert gaps[0] / gaps[1] == pytest.approx(2.0, rel=0.2)


def test_step_response_is_close_to_the_sampled_batch():
    """The batch's 1 kHz and its held torque change a step of 0.01 rad by less than 2 %."""
    goal = Q + np.array([0, 0.01, 0, 0])
    reference = movement.from_postures([0, 2], [goal, goal])
    frictionless = closed_loop.simulate(
        ARM_GAINS, reference, friction=False, q0=Q, settled=True, record=[0]
    )
    system = linearise.arm(Q, gains=ARM_GAINS, friction=False)
    response = control.step_response(system, reference.t, squeeze=False).outputs[:, 1]
    found = (frictionless.trajectory(0).q - Q) / 0.01
    np.testing.assert_allclose(found, response.T, atol=0.02)


def test_poles_of_the_thesis_gains_are_stable_all_over_the_workspace():
    rng = np.random.default_rng(0)
    postures = rng.uniform(BACKHOE.lower, BACKHOE.upper, (200, 4))
    slowest = [linearise.arm(q, gains=THESIS, friction=False).poles().real.max() for q in postures]
    assert max(slowest) < -0.05


def test_35_as_printed_has_poles_far_on_the_right():
    """+K_d dq feeds speed back with the wrong sign; the corrected one is stable."""
    pushing = THESIS._replace(kd=-THESIS.kd)
    for q in np.random.default_rng(1).uniform(BACKHOE.lower, BACKHOE.upper, (50, 4)):
        printed = linearise.arm(q, gains=pushing, friction=False).poles().real
        assert (printed > 0).sum() >= 4
        assert printed.max() > 500


def test_the_arm_alone_falls_over_when_the_boom_is_raised():
    """With the centre of mass above the boom's joint gravity drives it away."""
    raised = linearise.arm(np.radians([0, 55, -20, 0]), friction=False).poles()
    hanging = linearise.arm(np.radians([0, -45, 20, 110]), friction=False).poles()
    assert raised.real.max() > 0.5
    assert hanging.real.max() < 1e-6


def test_loop_closes_into_the_closed_loop():
    """1 / (1 + L) has the poles of the whole system, whichever joint it is cut at."""
    whole = linearise.arm(Q, gains=THESIS)
    for joint in JOINTS:
        around = control.feedback(linearise.loop(Q, THESIS, joint), 1)
        np.testing.assert_allclose(
            np.sort_complex(around.poles()), np.sort_complex(whole.poles()), rtol=1e-5, atol=1e-7
        )


def test_margins_say_at_which_gain_the_swing_s_loop_becomes_unstable():
    """The swing turns alone: its loop is that of one inertia, worked out by hand."""
    kp, ki, kd = (gain[0] for gain in THESIS)
    M11 = dynamics.mass_matrix(Q)[0, 0]
    by_hand = control.tf([kd, kp, ki], [M11, BACKHOE.viscous[0], 0, 0])
    found = linearise.loop(Q, THESIS, "swing")
    for frequency in (0.05, 1.0, 30.0):
        assert found(1j * frequency) == pytest.approx(by_hand(1j * frequency), rel=1e-9)
    np.testing.assert_allclose(control.margin(found), control.margin(by_hand), rtol=1e-4)


def test_systems_have_names():
    plant, controlled = linearise.arm(Q), linearise.arm(Q, gains=THESIS)
    assert plant.name == "arm"
    assert controlled.name == "arm under pid"
    assert controlled.input_labels == [f"ref_{joint}" for joint in JOINTS]
    assert plant.state_labels[4] == "dq_swing"
    assert linearise.arm(Q, name="loaded").name == "loaded"
    assert linearise.loop(Q, THESIS, "boom").name == "loop of the boom"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: linearise.arm(np.zeros((2, 4))), r"q must be one posture .* got shape \(2"),
        (lambda: linearise.arm([0, 0, np.nan, 0]), "q must be finite"),
        (
            lambda: linearise.arm(Q, gains=Gains(*np.ones((3, 2)))),
            r"gains must be kp, ki and kd .* got shape \(3, 2\)",
        ),
        (
            lambda: linearise.arm(Q, gains=Gains(1.0, 2.0, 3.0)),
            r"gains must be kp, ki and kd .* got shape \(3,\)",
        ),
        (
            lambda: linearise.arm(Q, gains=THESIS._replace(kd=np.full(4, np.inf))),
            r"gains must be finite, got inf at index \(2, 0\)",
        ),
        (lambda: linearise.arm(Q, gains=THESIS, law="computed_torque"), "law must be one of pid"),
        (lambda: linearise.loop(Q, THESIS, "arm"), "joint must be one of swing"),
    ],
)
def test_bad_arguments_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_three_rows_in_an_order_of_one_s_own_are_no_gains():
    with pytest.raises(TypeError, match=r"gains must be a Gains, got tuple: give pid\.Gains"):
        linearise.arm(Q, gains=tuple(THESIS))
