"""The digital PID against transfer functions, and its behaviour at the limits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import cont2discrete, lfilter

from backhoe.arm.pid import DigitalPID

DT = 0.01
KP, KI, KD = 2.0, 3.0, 0.4
RULES = {"backward": "backward_diff", "tustin": "bilinear", "forward": "euler"}


def signal(n=300):
    rng = np.random.default_rng(3)
    return np.cumsum(rng.normal(size=n)) / 10


def outputs(pid, reference, measured):
    return np.array([pid(*pair) for pair in zip(reference, measured, strict=True)])


def filtered_derivative(form, time):
    """Coefficients of k_d s / (T_f s + 1), discretised by SciPy."""
    b, a, _ = cont2discrete(([KD, 0], [time, 1]), DT, method=RULES[form])
    return b.ravel(), a


@pytest.mark.parametrize("form", RULES)
def test_output_is_that_of_the_discretised_transfer_function(form):
    y = signal()
    y = y - y[0]  # the filters below start from rest, the PID from its first sample
    time = 0.02
    pid = DigitalPID(KP, KI, KD, DT, filter_time=time, form=form)
    found = outputs(pid, np.zeros_like(y), y)
    integral = lfilter([DT, 0.0], [1.0, -1.0], -y)
    derivative = lfilter(*filtered_derivative(form, time), -y)
    np.testing.assert_allclose(found, -KP * y + KI * integral + derivative, atol=1e-12)


def test_derivative_of_46_as_printed_is_the_backward_difference_and_not_tustins():
    """D'Angelo's coefficient K_d / (K_d + N T_s), with K_d in s, beside what SciPy gives."""
    K, Kd, N = KP, KD / KP, 15.0
    as_printed = Kd / (Kd + N * DT)
    poles = {form: -filtered_derivative(form, Kd / N)[1][1] for form in ("backward", "tustin")}
    assert as_printed == pytest.approx(poles["backward"], abs=1e-12)
    assert abs(as_printed - poles["tustin"]) > 0.02
    pid = DigitalPID.from_factored(K, 0.0, Kd, DT, derivative_filter=N)
    y = signal(50)
    outputs(pid, np.zeros(49), y[:49])
    before = pid.derivative
    pid(0.0, y[49])
    step = K * Kd * N / (Kd + N * DT) * (y[49] - y[48])
    assert pid.derivative == pytest.approx(as_printed * before - step, abs=1e-12)


def test_without_filter_it_is_328_as_printed():
    e = signal()
    K, Ti, Td = 1.7, 0.8, 0.15
    pid = DigitalPID.from_ideal(K, Ti, Td, DT, derivative_of="error")
    quotient = np.diff(e, prepend=e[0]) / DT
    expected = K * (e + np.cumsum(e) * DT / Ti + Td * quotient)
    np.testing.assert_allclose(outputs(pid, e, np.zeros_like(e)), expected, rtol=1e-12)


def test_without_integral_time_there_is_no_integral():
    assert DigitalPID.from_ideal(2.0, np.inf, 0.1, DT).ki == 0.0


def test_n_loops_at_once_are_n_loops_one_by_one():
    rng = np.random.default_rng(0)
    gains = rng.uniform(0.5, 3.0, (3, 5))
    reference, measured = rng.normal(size=(2, 200, 5)).cumsum(axis=1) / 5
    high = rng.uniform(1.0, 2.0, 5)
    together = DigitalPID(*gains, DT, derivative_filter=8.0, limits=(-0.5, high))
    found = outputs(together, reference, measured)
    for loop in range(5):
        alone = DigitalPID(*gains[:, loop], DT, derivative_filter=8.0, limits=(-0.5, high[loop]))
        column = outputs(alone, reference[:, loop], measured[:, loop])
        np.testing.assert_array_equal(found[:, loop], column)
        assert isinstance(alone(1.0, 0.0), float)


def test_a_jump_of_the_reference_gives_no_kick():
    smooth = DigitalPID(1.0, 0.0, 5.0, DT)
    kicking = DigitalPID(1.0, 0.0, 5.0, DT, derivative_of="error")
    for pid in (smooth, kicking):
        pid(0.0, 0.3)
    assert smooth(1.0, 0.3) == pytest.approx(0.7)
    assert kicking(1.0, 0.3) == pytest.approx(0.7 + 5.0 / DT)


@pytest.mark.parametrize("derivative_of", ["measurement", "error"])
def test_the_first_sample_has_no_derivative(derivative_of):
    pid = DigitalPID(1.0, 0.0, 5.0, DT, derivative_of=derivative_of)
    assert pid(4.0, 1.0) == 3.0
    pid(4.0, 2.0)
    pid.reset()
    assert pid(4.0, 1.0) == 3.0


def closed_loop(pid, steps, limit=1.0):
    """A lag of 1 s behind an actuator of gain 2: the largest overshoot of a step of 1."""
    y, peak = 0.0, 0.0
    for _ in range(steps):
        u = pid(1.0, y)
        assert -limit <= u <= limit
        y += DT * (2 * u - y)
        peak = max(peak, y)
    return y, peak


def test_clamping_spares_the_overshoot_that_windup_brings():
    limits = (-1.0, 1.0)
    settled, clamped = closed_loop(DigitalPID(5.0, 20.0, 0.0, DT, limits=limits), 2000)
    pid = DigitalPID(5.0, 20.0, 0.0, DT, limits=limits, anti_windup="none")
    also_settled, wound_up = closed_loop(pid, 2000)
    assert settled == pytest.approx(1.0, abs=1e-6)
    assert also_settled == pytest.approx(1.0, abs=1e-6)
    assert wound_up - 1 > 3 * (clamped - 1)


numbers = st.floats(-10, 10)


@settings(max_examples=200, deadline=None)
@given(
    samples=st.lists(st.tuples(numbers, numbers), min_size=1, max_size=30),
    gains=st.tuples(*3 * [st.floats(0, 5)]),
    high=st.floats(0.1, 5),
)
def test_clamping_never_moves_the_integral_further_out(samples, gains, high):
    pid = DigitalPID(*gains, DT, filter_time=0.05, limits=(-1.0, high))
    for reference, measured in samples:
        before = pid.integral
        output = pid(reference, measured)
        step = gains[1] * DT * (reference - measured)
        change = pid.integral - before
        wanted = pid.proportional + pid.integral + pid.derivative
        assert -1.0 <= output <= high
        assert output == min(max(wanted, -1.0), high)
        assert abs(change) <= abs(step) + 1e-12 and change * step >= 0
        if change > 1e-12:
            assert wanted <= high + 1e-9
        elif change < -1e-12:
            assert wanted >= -1.0 - 1e-9
        elif abs(step) > 1e-9:
            assert wanted >= high - 1e-9 if step > 0 else wanted <= -1.0 + 1e-9


def test_tustin_rings_where_the_filter_is_faster_than_half_a_sample():
    pid = DigitalPID(0.0, 0.0, 1.0, DT, filter_time=0.001, form="tustin")
    outputs(pid, [0.0, 0.0], [0.0, -1.0])
    signs = [np.sign(pid(0.0, -1.0)) for _ in range(4)]
    assert signs == [-1, 1, -1, 1]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"kp": -1.0}, "kp must not be negative, got -1.0"),
        ({"ki": np.nan}, "ki must be finite, got nan"),
        ({"kd": [[1.0]]}, r"kd must be one number or shape \(n,\)"),
        ({"kd": "1"}, "kd must be numbers, got '1'"),
        ({"kp": [1.0, 2.0], "ki": [1.0, 2.0, 3.0]}, "one length, got lengths"),
        ({"dt": 0.0}, r"dt must be one number above 0 \[s\], got 0.0"),
        ({"dt": np.nan}, r"dt must be one number above 0 \[s\], got nan"),
        ({"derivative_filter": 0.0}, "derivative_filter must be one number above 0"),
        ({"derivative_filter": 5.0, "filter_time": 0.1}, "not both"),
        ({"derivative_filter": 5.0, "kp": 0.0}, "give filter_time in s instead"),
        ({"filter_time": -0.1}, "filter_time must not be negative"),
        ({"limits": (1.0, -1.0)}, "low below high"),
        ({"limits": 5.0}, r"limits must be \(low, high\)"),
        ({"limits": (np.nan, 1.0)}, "low below high"),
        ({"limits": (["a"], 1.0)}, "limits must be numbers"),
        ({"anti_windup": "clamp"}, "anti_windup must be one of"),
        ({"form": "bilinear"}, "form must be one of"),
        ({"derivative_of": "output"}, "derivative_of must be one of"),
        ({"form": "tustin"}, 'unstable: form "tustin" needs a filter_time T_f above 0'),
        ({"form": "forward", "filter_time": 0.004}, "above dt / 2 = 0.005 s"),
    ],
)
def test_bad_arguments_are_named(options, message):
    arguments = {"kp": 1.0, "ki": 1.0, "kd": 1.0, "dt": DT} | options
    with pytest.raises(ValueError, match=message):
        DigitalPID(**arguments)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((np.nan, 0.0), "reference must be one finite number, got nan"),
        ((0.0, np.inf), "measured must be one finite number, got inf"),
        (([1.0, 2.0], 0.0), r"reference must be one finite number, got \[1.0, 2.0\]"),
        ((0.0, "1"), "measured must be one finite number, got '1'"),
    ],
)
def test_bad_samples_are_refused_and_leave_the_pid_as_it_was(arguments, message):
    pid, twin = (DigitalPID(1.0, 2.0, 0.1, DT) for _ in range(2))
    for one in (pid, twin):
        one(1.0, 0.5)
    with pytest.raises(ValueError, match=message):
        pid(*arguments)
    assert pid(1.0, 0.7) == twin(1.0, 0.7)


def test_bad_samples_of_many_loops_are_refused():
    pid = DigitalPID([1.0, 2.0], 0.0, 0.0, DT)
    with pytest.raises(
        ValueError, match=r"measured must be one for each loop, shape \(2,\), got shape \(\)"
    ):
        pid([1.0, 1.0], 0.0)
    with pytest.raises(ValueError, match="reference must be finite, got nan at index 1"):
        pid([1.0, np.nan], [0.0, 0.0])


def test_integral_time_must_be_positive():
    with pytest.raises(ValueError, match="Ti must be positive"):
        DigitalPID.from_ideal(1.0, 0.0, 0.1, DT)


def test_state_at_100_hz_gives_a_loop_at_1_khz_a_derivative_of_0_and_10_times_the_speed():
    """A ramp of 1 unit/s; also that a filter spreads the peaks without changing their mean."""
    dt = 0.001
    seen = dt * np.repeat(np.arange(0, 1010, 10), 10)[:1001]
    raw = DigitalPID(0.0, 0.0, 1.0, dt)
    smooth = DigitalPID(0.0, 0.0, 1.0, dt, filter_time=0.03)
    quotient = -outputs(raw, np.zeros(1001), seen)[1:]
    assert np.mean(np.abs(quotient) < 1e-9) == pytest.approx(0.9)
    np.testing.assert_allclose(quotient[np.abs(quotient) > 1e-9], 10.0)
    settled = -outputs(smooth, np.zeros(1001), seen)[501:]
    assert settled.mean() == pytest.approx(1.0, rel=1e-3)
    assert np.ptp(settled) < 0.4
