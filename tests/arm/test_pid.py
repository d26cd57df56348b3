import numpy as np
import pytest

from backhoe.arm.pid import ARM_GAINS, PID

DT = 1e-3


def drive(pid, steps, inertia=500.0, load=0.0, target=0.5):
    q, dq = np.zeros(1), np.zeros(1)
    for _ in range(steps):
        torque = pid(np.array([target]), np.zeros(1), q, dq, DT)
        dq = dq + DT * (torque - load) / inertia
        q = q + DT * dq
    return q[0], dq[0]


def test_torque_is_the_sum_of_three_terms_on_the_first_sample():
    pid = PID(kp=[2.0], ki=[3.0], kd=[5.0])
    torque = pid(np.array([1.0]), np.array([0.5]), np.array([0.2]), np.array([0.1]), 0.1)
    assert torque == pytest.approx(2.0 * 0.8 + 3.0 * 0.8 * 0.1 + 5.0 * 0.4)


def test_integral_removes_the_error_that_a_constant_load_leaves():
    load = 4000.0
    without, _ = drive(PID([4e4], [0.0], [9e3]), 6000, load=load)
    with_integral, _ = drive(PID([4e4], [4e4], [9e3]), 12000, load=load)
    assert 0.5 - without == pytest.approx(load / 4e4, rel=1e-3)
    assert abs(0.5 - with_integral) < 1e-3


def test_integral_waits_while_the_torque_is_at_its_limit():
    limited = PID([4e4], [4e4], [9e3], torque_limit=[500.0])
    wound_up = PID([4e4], [4e4], [9e3])
    drive(limited, 400)
    q, dq = np.zeros(1), np.zeros(1)
    for _ in range(400):
        torque = np.clip(wound_up(np.array([0.5]), np.zeros(1), q, dq, DT), -500, 500)
        dq = dq + DT * torque / 500.0
        q = q + DT * dq
    assert 0 <= limited.integral[0] < wound_up.integral[0]


def test_reset_forgets_the_integral():
    pid = PID([1.0], [1.0], [1.0])
    first = pid(np.ones(1), np.zeros(1), np.zeros(1), np.zeros(1), DT)
    pid(np.ones(1), np.zeros(1), np.zeros(1), np.zeros(1), DT)
    pid.reset()
    assert pid(np.ones(1), np.zeros(1), np.zeros(1), np.zeros(1), DT) == first


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ([1.0, 2.0], [1.0], [1.0, 1.0]),
            r"ki must have shape \(2,\), got shape \(1,\)",
        ),
        (([1.0], [-1.0], [1.0]), "ki must not be negative"),
        (([np.nan], [1.0], [1.0]), "kp must be finite"),
        (([1.0], [1.0], [1.0], [0.0]), "torque_limit must be above 0 N m"),
    ],
)
def test_bad_gains_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        PID(*arguments)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"q_ref": np.full(4, np.nan)}, "q_ref - q must be finite, got nan at index 0"),
        ({"dq": np.full(4, np.inf)}, "dq_ref - dq must be finite, got -inf at index 0"),
        ({"q_ref": np.zeros((1, 4))}, r"q_ref - q must have shape \(4,\), got shape \(1, 4\)"),
        ({"dt": 0.0}, r"dt must be one number above 0 \[s\], got 0.0"),
        ({"dt": np.nan}, r"dt must be one number above 0 \[s\], got nan"),
    ],
)
def test_a_bad_sample_is_refused_and_leaves_the_integral_alone(change, says):
    sample = {name: np.zeros(4) for name in ("q_ref", "dq_ref", "q", "dq")} | {"dt": 0.001}
    control = PID(*ARM_GAINS)
    with pytest.raises(ValueError, match=says):
        control(**(sample | change))
    assert control.integral == [0.0] * 4
