"""Bad input to the filters: what was expected, what came, and a filter left as it was."""

import subprocess
import sys

import numpy as np
import pytest

from backhoe.localisation import kalman

Q, R, P0, X0 = 0.1 * np.eye(2), np.array([[0.5]]), np.eye(2), np.zeros(2)
F, H = np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([[1.0, 0.0]])


def extended(**changes):
    parts = {
        "f": lambda x, u, dt: x @ F.T,
        "F": F,
        "h": lambda x: x[..., :1],
        "H": H,
        "Q": Q,
        "R": R,
        "x0": X0,
        "P0": P0,
        **changes,
    }
    return kalman.ExtendedKalmanFilter(**parts)


def unscented(**changes):
    parts = {"f": lambda x, u, dt: x @ F.T, "h": lambda x: x[..., :1], "Q": Q, "R": R}
    return kalman.UnscentedKalmanFilter(**{**parts, "x0": X0, "P0": P0, **changes})


def batch(**changes):
    parts = {
        "f": lambda x, u, dt: x @ F.T,
        "F": F,
        "h": lambda x: x[..., :1],
        "H": H,
        "Q": Q,
        "R": R,
        "x0": np.zeros((3, 2)),
        "P0": P0,
        **changes,
    }
    return kalman.BatchExtendedKalmanFilter(**parts)


MAKING = [
    ({"P0": [[1, 0.5], [0.1, 1]]}, "P0 must be symmetric"),
    ({"P0": np.diag([1, -1])}, "P0 must be positive semidefinite"),
    ({"P0": np.eye(3)}, r"P0 must be a covariance of shape \(2, 2\).*, got shape \(3, 3\)"),
    ({"P0": np.diag([1, np.nan])}, "P0 must be finite"),
    ({"P0": "large"}, "P0 must be numbers"),
    ({"Q": np.diag([1, -1])}, "Q must be positive semidefinite"),
    ({"R": [[0.0]]}, "R must be positive definite, its lowest eigenvalue is 0"),
    ({"R": np.eye(2)}, r"R must be a covariance of shape \(1, 1\), got shape \(2, 2\)"),
    ({"angles": (2,)}, "angles must be indices from 0 to 1"),
    ({"measurement_angles": (1,)}, "measurement_angles must be indices from 0 to 0"),
    ({"time": np.nan}, r"time must be one finite number \[s\]"),
    ({"R": None}, "R, the covariance of its noise, must come"),
]


@pytest.mark.parametrize("make", [extended, unscented, batch])
@pytest.mark.parametrize(("changes", "message"), MAKING)
def test_a_filter_is_not_made_of_what_is_none(make, changes, message):
    with pytest.raises(ValueError, match=message):
        make(**changes)


@pytest.mark.parametrize(
    ("make", "changes", "message"),
    [
        (extended, {"x0": [[0.0, 0.0]]}, r"x0 must be the state at the start, shape \(n,\)"),
        (extended, {"x0": [np.inf, 0.0]}, "x0 must be finite"),
        (extended, {"F": np.eye(3)}, r"F must have shape \(2, 2\), got shape \(3, 3\)"),
        (extended, {"h": None, "H": [1.0, 0.0]}, r"H must have shape \(m, 2\), got shape \(2,\)"),
        (extended, {"h": None, "H": lambda x: H}, "h must come with an H that is a function"),
        (unscented, {"alpha": 0.0}, "alpha must be one number above 0 and at most 1"),
        (unscented, {"kappa": -2.0}, "kappa must be one number above -2"),
        (batch, {"x0": [0.0, 0.0]}, r"x0 must be the states of N runs, shape \(N, n\)"),
        (batch, {"h": lambda x: x[0]}, r"h\(x\) must work over leading axes"),
    ],
)
def test_each_kind_names_its_own_arguments(make, changes, message):
    with pytest.raises(ValueError, match=message):
        make(**changes)


@pytest.mark.parametrize("make", [extended, unscented, batch])
@pytest.mark.parametrize("dt", [0.0, -0.1, np.nan, np.inf, "1 s", [0.1, 0.1]])
def test_time_goes_forwards(make, dt):
    filter = make()
    with pytest.raises(ValueError, match=r"dt must be one number above 0 \[s\], got"):
        filter.predict(None, dt)
    assert filter.time == 0.0


@pytest.mark.parametrize("make", [extended, unscented, batch])
def test_a_measurement_belongs_to_the_time_of_the_state(make):
    filter = make(time=1.0)
    filter.predict(None, 0.5)
    z = np.full((*filter.x.shape[:-1], 1), 0.2)
    with pytest.raises(ValueError, match=r"of 1\.4 s is older than the state of 1\.5 s"):
        filter.update(z, time=1.4)
    with pytest.raises(ValueError, match=r"of 1\.6 s is newer than the state of 1\.5 s: .*predict"):
        filter.update(z, time=1.6)
    filter.update(z, time=1.5)


@pytest.mark.parametrize("make", [extended, unscented, batch])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_measurement_that_is_no_number_changes_nothing(make, value):
    filter = make()
    before = filter.x, filter.P
    z = np.full((*filter.x.shape[:-1], 1), 0.2)
    z[-1] = value
    with pytest.raises(ValueError, match="must be finite"):
        filter.update(z)
    assert filter.x is before[0] and filter.P is before[1]


def test_a_batch_says_which_run_it_is():
    filter = batch()
    with pytest.raises(ValueError, match="in run 1: z must be finite"):
        filter.update([[0.1], [np.nan], [0.2]])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda f: f.update([1.0, 2.0]), r"z must have shape \(1,\), got shape \(2,\)"),
        (lambda f: f.update("east"), "z must be numbers"),
        (lambda f: f.update([1.0], R=[[-1.0]]), "R must be positive definite"),
        (lambda f: f.update([1.0], R=np.eye(2)), r"R must be a covariance of shape \(1, 1\)"),
        (lambda f: f.update([1.0], h=lambda x: x[:1]), "R, the covariance of its noise, must"),
        (lambda f: f.update([1.0], H=H), "R, the covariance of its noise, must"),
        (lambda f: f.update([1.0], H=H.T, R=R), r"H must have shape \(m, 2\), got shape \(2, 1\)"),
        (
            lambda f: f.update([1.0], h=lambda x: x[:1], H=lambda x: H.T, R=R),
            r"H\(x\) must have shape \(1, 2\), got shape \(2, 1\)",
        ),
        (
            lambda f: f.update([1.0], h=lambda x: np.eye(2), R=R),
            r"h\(x\) must have shape \(m,\), got shape \(2, 2\)",
        ),
        (lambda f: f.update([1.0], h=lambda x: [np.nan], H=H, R=R), r"h\(x\) must be finite"),
        (lambda f: f.update([1.0], angles=(1,)), "angles must be indices from 0 to 0"),
        (lambda f: setattr(f, "P", [[1, 2], [3, 4]]), "P must be symmetric"),
        (lambda f: setattr(f, "x", [1.0]), r"x must have shape \(2,\)"),
    ],
)
def test_an_update_names_what_is_wrong(call, message):
    filter = extended()
    before = filter.x, filter.P
    with pytest.raises(ValueError, match=message):
        call(filter)
    assert filter.x is before[0] and filter.P is before[1]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"f": lambda x, u, dt: x[:1]}, r"f\(x, u, dt\) must have shape \(2,\), got shape \(1,\)"),
        (
            {"f": lambda x, u, dt: x[:1], "F": None},
            r"f\(x, u, dt\) must have shape \(2,\), got shape \(1,\)",
        ),
        ({"f": lambda x, u, dt: x + np.nan}, r"f\(x, u, dt\) must be finite"),
        ({"F": lambda x, u, dt: np.eye(3)}, r"F\(x, u, dt\) must have shape \(2, 2\)"),
        ({"F": lambda x, u, dt: np.nan * F}, r"F\(x, u, dt\) must be finite"),
        ({"Q": lambda x, u, dt: np.diag([1, -1])}, r"Q\(x, u, dt\) must be positive semidefinite"),
        ({"Q": lambda x, u, dt: [[1, 1], [0, 1]]}, r"Q\(x, u, dt\) must be symmetric"),
        ({"Q": lambda x, u, dt: 1.0}, r"Q\(x, u, dt\) must have shape \(2, 2\)"),
    ],
)
def test_a_model_that_gives_nonsense_is_named(changes, message):
    filter = extended(**changes)
    with pytest.raises(ValueError, match=message):
        filter.predict(None, 0.1)
    assert filter.time == 0.0 and (filter.P == P0).all()


def test_a_noise_that_turns_negative_later_is_named():
    filter = extended(Q=lambda x, u, dt: np.diag([u, 1.0]))
    filter.predict(1.0, 0.1)
    with pytest.raises(ValueError, match=r"Q\(x, u, dt\) must be positive semidefinite"):
        filter.predict(-50.0, 0.1)


def test_without_a_sensor_an_update_asks_for_one():
    filter = extended(h=None, H=None, R=None)
    with pytest.raises(ValueError, match="no sensor of its own: give h"):
        filter.update([1.0])
    filter.update([1.0], H=H, R=R)
    assert filter.x[0] == pytest.approx(2 / 3)


def test_a_kalman_filter_takes_straight_models_alone():
    filter = kalman.KalmanFilter(F, H, Q, R, X0, P0)
    with pytest.raises(ValueError, match="take ExtendedKalmanFilter"):
        filter.update([1.0], h=lambda x: x[:1], R=R)
    with pytest.raises(ValueError, match="u must be None, since the filter has no B"):
        filter.predict([1.0], 0.1)
    driven = kalman.KalmanFilter(F, H, Q, R, X0, P0, B=[[0.0], [1.0]])
    with pytest.raises(ValueError, match=r"u must have shape \(1,\)"):
        driven.predict([1.0, 2.0], 0.1)
    with pytest.raises(ValueError, match=r"B must have shape \(2, k\)"):
        kalman.KalmanFilter(F, H, Q, R, X0, P0, B=[[1.0]]).predict([1.0], 0.1)


def test_a_start_known_exactly_is_accepted():
    filter = extended(P0=np.zeros((2, 2)))
    filter.predict(None, 1.0)
    np.testing.assert_allclose(filter.P, Q)


def test_a_history_wants_one_prediction_at_a_time():
    filter = extended()
    history = kalman.History(filter)
    with pytest.raises(ValueError, match="got 0 predictions"):
        history.add()
    with pytest.raises(ValueError, match="history is empty"):
        kalman.rts_smoother(history)
    filter.predict(None, 0.1)
    filter.predict(None, 0.1)
    with pytest.raises(ValueError, match="got 2 predictions"):
        history.add()
    with pytest.raises(
        TypeError, match="a history's filter must be a ExtendedKalmanFilter, got Uns"
    ):
        kalman.History(unscented())


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: kalman.transition([[1, 2]], 0.1),
            r"A must have shape \(1, 1\), got shape \(1, 2\)",
        ),
        (lambda: kalman.transition(np.eye(2), 0.0), r"dt must be one number above 0 \[s\]"),
        (
            lambda: kalman.transition(np.eye(2), 0.1, order=0),
            "order must be one whole number at least 1",
        ),
        (
            lambda: kalman.unobservable([np.eye(2)], np.ones((2, 1, 3))),
            r"F must have shape \(1, 3, 3",
        ),
        (lambda: kalman.gain(np.eye(2), np.eye(3), np.eye(3)), "H has shape"),
        (lambda: kalman.numerical_jacobian(lambda x: x[0], [[1.0], [2.0]]), "function must return"),
        (
            lambda: kalman.least_squares(F, H, np.zeros((2, 2)), R, [[1.0]], X0, P0),
            "Q must be positive definite",
        ),
        (lambda: kalman.least_squares(F, H, Q, R, [1.0], X0, P0), r"z must have shape \(K, m\)"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_importing_the_filters_loads_nothing_heavy():
    code = "import sys; from backhoe.localisation import imu, kalman; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert {"numba", "scipy", "filterpy", "matplotlib"}.isdisjoint(loaded.stdout.split())
