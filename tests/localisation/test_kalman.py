"""The filters against batch least squares, each other, differences and FilterPy."""

import numpy as np
import pytest

from backhoe.basics.angles import residual, wrap
from backhoe.localisation import kalman
from backhoe.localisation.kalman import engine

filterpy = pytest.importorskip("filterpy.kalman")

DT = 0.1
F = np.array([[1.0, DT], [0.0, 1.0]])
B = np.array([[DT**2 / 2], [DT]])
H = np.array([[1.0, 0.0]])
Q = 0.04 * np.array([[DT**4 / 4, DT**3 / 2], [DT**3 / 2, DT**2]]) + 1e-6 * np.eye(2)
R = np.array([[0.09]])
X0, P0 = np.array([0.3, -0.1]), np.diag([1.0, 0.5])


def linear_data(steps=60, seed=0):
    rng = np.random.default_rng(seed)
    u = np.sin(0.1 * np.arange(steps))[:, None]
    x, z = rng.multivariate_normal(X0, P0), []
    for k in range(steps):
        x = F @ x + B @ u[k] + rng.multivariate_normal([0, 0], Q)
        z.append(H @ x + 0.3 * rng.standard_normal(1))
    return u, np.array(z)


def motion(x, u, dt):
    v, omega = u[..., 0], u[..., 1]
    heading = x[..., 2] + omega * dt / 2
    step = np.stack([v * np.cos(heading), v * np.sin(heading), omega + 0 * heading], axis=-1)
    return x + dt * step


def motion_jacobian(x, u, dt):
    heading = x[..., 2] + u[..., 1] * dt / 2
    J = np.zeros((*x.shape, 3))
    J[...] = np.eye(3)
    J[..., 0, 2] = -u[..., 0] * dt * np.sin(heading)
    J[..., 1, 2] = u[..., 0] * dt * np.cos(heading)
    return J


MARK = np.array([4.0, 1.0])


def to_mark(x):
    """Range and bearing of a landmark."""
    dx, dy = MARK[0] - x[..., 0], MARK[1] - x[..., 1]
    return np.stack([np.hypot(dx, dy), np.arctan2(dy, dx) - x[..., 2]], axis=-1)


def to_mark_jacobian(x):
    dx, dy = MARK[0] - x[..., 0], MARK[1] - x[..., 1]
    r = np.hypot(dx, dy)
    zero, one = np.zeros_like(r), np.ones_like(r)
    rows = [[-dx / r, -dy / r, zero], [dy / r**2, -dx / r**2, -one]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


Q3, R2 = np.diag([1e-3, 1e-3, 4e-4]), np.diag([0.02, 0.001])


def robot(kind=kalman.ExtendedKalmanFilter, **options):
    models = (
        (motion, to_mark)
        if kind in (kalman.UnscentedKalmanFilter, kalman.ParticleFilter)
        else (motion, motion_jacobian, to_mark, to_mark_jacobian)
    )
    return kind(
        *models,
        Q3,
        R2,
        np.zeros(3),
        0.05 * np.eye(3),
        angles=(2,),
        measurement_angles=(1,),
        **options,
    )


def robot_data(steps=80, seed=1):
    rng = np.random.default_rng(seed)
    u = np.stack([1 + 0.2 * rng.standard_normal(steps), 0.5 * np.ones(steps)], axis=-1)
    x, z, states = np.zeros(3), [], []
    for command in u:
        x = motion(x, command, DT) + rng.multivariate_normal(np.zeros(3), Q3)
        z.append(to_mark(x) + rng.multivariate_normal(np.zeros(2), R2))
        states.append(x)
    return u, np.array(z), np.array(states)


def linear_filter():
    return kalman.KalmanFilter(F, H, Q, R, X0, P0, B=B)


def run(filter, u, z, dt=DT):
    for command, measured in zip(u, z, strict=True):
        filter.predict(command, dt)
        filter.update(measured)
    return filter


# ---- the Kalman filter


def test_the_last_state_is_that_of_least_squares_over_the_whole_history():
    _, z = linear_data()
    filter = kalman.KalmanFilter(F, H, Q, R, X0, P0)
    run(filter, [None] * len(z), z)
    x, P = kalman.least_squares(F, H, Q, R, z, X0, P0)
    np.testing.assert_allclose(filter.x, x[-1], rtol=0, atol=1e-10)
    np.testing.assert_allclose(filter.P, P[-1], rtol=0, atol=1e-11)


def test_the_smoother_gives_every_state_of_least_squares():
    _, z = linear_data()
    filter = kalman.KalmanFilter(F, H, Q, R, X0, P0)
    history = kalman.History(filter)
    for measured in z:
        filter.predict(None, DT)
        filter.update(measured)
        history.add()
    smoothed = kalman.rts_smoother(history)
    x, P = kalman.least_squares(F, H, Q, R, z, X0, P0)
    np.testing.assert_allclose(smoothed.x, x, rtol=0, atol=1e-9)
    np.testing.assert_allclose(smoothed.P, P, rtol=0, atol=1e-10)
    np.testing.assert_allclose(history.time, DT * np.arange(61))


def test_the_smoother_of_a_wrapped_heading_is_least_squares_of_its_turns():
    """The heading runs round and is brought back to -pi ... pi after each update."""
    rng = np.random.default_rng(6)
    turn, rate = np.array([[1.0, DT], [0.0, 1.0]]), np.array([[1.0, 0.0]])
    Q, R, x0, P0 = np.diag([1e-4, 1e-3]), np.array([[0.02]]), [0.0, 2.0], np.diag([0.1, 0.5])
    z = 2.0 * DT * np.arange(1, 81)[:, None] + np.sqrt(R[0, 0]) * rng.standard_normal((80, 1))
    filter = kalman.KalmanFilter(turn, rate, Q, R, x0, P0, angles=(0,), measurement_angles=(0,))
    history = kalman.History(filter)
    for measured in z:
        filter.predict(None, DT)
        filter.update(wrap(measured))
        filter.x = [wrap(filter.x[0]), filter.x[1]]
        history.add()
    smoothed = kalman.rts_smoother(history)
    x, P = kalman.least_squares(turn, rate, Q, R, z, x0, P0)
    assert np.ptp(x[:, 0]) > 2 * np.pi
    np.testing.assert_allclose(wrap(smoothed.x[:, 0] - x[:, 0]), 0, atol=1e-9)
    np.testing.assert_allclose(smoothed.x[:, 1], x[:, 1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(smoothed.P, P, rtol=0, atol=1e-10)


def test_filter_and_smoother_agree_with_filterpy():
    u, z = linear_data()
    theirs = filterpy.KalmanFilter(2, 1, 1)
    theirs.x, theirs.P, theirs.F, theirs.B = X0.copy(), P0.copy(), F, B
    theirs.H, theirs.Q, theirs.R = H, Q, R
    ours, rows = linear_filter(), []
    history = kalman.History(ours)
    for command, measured in zip(u, z, strict=True):
        theirs.predict(command)
        theirs.update(measured)
        ours.predict(command, DT)
        ours.update(measured)
        history.add()
        rows.append((theirs.x, theirs.P))
        np.testing.assert_allclose(ours.x, theirs.x, rtol=0, atol=1e-13)
        np.testing.assert_allclose(ours.P, theirs.P, rtol=0, atol=1e-13)
        np.testing.assert_allclose(ours.S, theirs.S, rtol=1e-12)
        assert ours.nis == pytest.approx(float(theirs.mahalanobis) ** 2)
    no_input = kalman.KalmanFilter(F, H, Q, R, X0, P0)
    history, xs, Ps = kalman.History(no_input), [], []
    for measured in z:
        no_input.predict(None, DT)
        no_input.update(measured)
        history.add()
        xs.append(no_input.x)
        Ps.append(no_input.P)
    x, P, _, _ = theirs.rts_smoother(np.array(xs), np.array(Ps))
    smoothed = kalman.rts_smoother(history)
    np.testing.assert_allclose(smoothed.x[1:], x, rtol=0, atol=1e-12)
    np.testing.assert_allclose(smoothed.P[1:], P, rtol=0, atol=1e-12)


def test_matrices_may_depend_on_the_step():
    def F_of(dt):
        return np.array([[1.0, dt], [0.0, 1.0]])

    varying = kalman.KalmanFilter(F_of, H, lambda dt: Q * dt / DT, R, X0, P0)
    fixed = kalman.KalmanFilter(F, H, Q, R, X0, P0)
    varying.predict(None, DT)
    fixed.predict(None, DT)
    np.testing.assert_allclose(varying.P, fixed.P, rtol=1e-14)
    varying.predict(None, 0.5)
    np.testing.assert_allclose(varying.F, F_of(0.5))
    assert varying.time == pytest.approx(0.6)


def test_the_terms_of_the_transition_tend_to_the_exponential():
    A = np.random.default_rng(5).normal(size=(3, 3))
    exact = kalman.transition(A, 0.1, order=None)
    np.testing.assert_allclose(kalman.transition(A, 0.1), np.eye(3) + 0.1 * A)
    away = [np.abs(kalman.transition(A, 0.1, order=k) - exact).max() for k in (1, 2, 3, 10)]
    assert away[3] < 1e-12 and all(np.diff(away) < 0)
    halved = np.abs(kalman.transition(A, 0.05, 2) - kalman.transition(A, 0.05, None)).max()
    assert away[1] / halved == pytest.approx(8, rel=0.1)


def test_one_update_is_the_equations_of_the_source():
    filter = linear_filter()
    K = kalman.gain(P0, H, R)
    filter.update([0.7])
    np.testing.assert_allclose(filter.K, K, rtol=1e-14)
    for form, rtol in ((kalman.update, 1e-14), (kalman.information_update, 1e-12)):
        x, P = form(X0, P0, [0.7], H, R)
        np.testing.assert_allclose(filter.x, x, rtol=rtol)
        np.testing.assert_allclose(filter.P, P, rtol=rtol)


def test_two_sensors_after_another_are_both_at_once():
    both, apart = linear_filter(), linear_filter()
    both.update([0.5, 0.2], H=np.eye(2), R=np.diag([0.09, 0.3]))
    apart.update([0.5])
    apart.update(0.2, H=[[0.0, 1.0]], R=0.3)
    np.testing.assert_allclose(apart.x, both.x, rtol=1e-12)
    np.testing.assert_allclose(apart.P, both.P, rtol=1e-12)


# ---- the extended Kalman filter


def test_the_extended_filter_agrees_with_filterpy_on_the_same_models():
    class Theirs(filterpy.ExtendedKalmanFilter):
        def predict_x(self, u=0):
            self.x = motion(self.x, u, DT)

    u, z, _ = robot_data()
    theirs, ours = Theirs(3, 2), robot()
    theirs.x, theirs.P, theirs.Q, theirs.R = np.zeros(3), 0.05 * np.eye(3), Q3, R2
    for command, measured in zip(u, z, strict=True):
        theirs.F = motion_jacobian(theirs.x, command, DT)
        theirs.predict(command)
        theirs.update(
            measured,
            to_mark_jacobian,
            to_mark,
            residual=lambda a, b: residual(a, b, (1,)),
        )
        ours.predict(command, DT)
        ours.update(measured)
        np.testing.assert_allclose(ours.x, theirs.x, rtol=0, atol=1e-12)
        np.testing.assert_allclose(ours.P, theirs.P, rtol=0, atol=1e-13)


def test_the_extended_filter_of_straight_models_is_the_kalman_filter():
    u, z = linear_data()
    extended = kalman.ExtendedKalmanFilter(
        lambda x, u, dt: F @ x + B @ u, None, lambda x: H @ x, None, Q, R, X0, P0
    )
    run(extended, u, z)
    linear = run(linear_filter(), u, z)
    np.testing.assert_allclose(extended.x, linear.x, rtol=0, atol=1e-9)
    np.testing.assert_allclose(extended.P, linear.P, rtol=0, atol=1e-9)


def test_jacobians_are_the_models_derivatives():
    rng = np.random.default_rng(3)
    for x, u in zip(rng.normal(size=(20, 3)), rng.normal(size=(20, 2)), strict=True):
        by_difference = kalman.numerical_jacobian(lambda x, u=u: motion(x, u, DT), x)
        np.testing.assert_allclose(motion_jacobian(x, u, DT), by_difference, atol=1e-9)
        by_difference = kalman.numerical_jacobian(to_mark, x, angles=(1,))
        np.testing.assert_allclose(to_mark_jacobian(x), by_difference, atol=1e-8)


def test_an_angle_is_wrapped_in_the_innovation_and_never_in_the_state():
    filter = kalman.ExtendedKalmanFilter(
        lambda x, u, dt: x + u * dt, [[1.0]], lambda x: x, [[1.0]], [[1e-4]], [[1e-2]],
        [4 * np.pi + 0.1], [[1.0]], angles=(0,), measurement_angles=(0,),
    )  # fmt: skip
    filter.update([0.2])
    assert filter.innovation[0] == pytest.approx(0.1)
    assert filter.x[0] == pytest.approx(4 * np.pi + 0.1 + 0.1 / 1.01)


def test_an_unwrapped_innovation_throws_the_heading_off():
    u, z, states = robot_data(steps=200)
    z = z.copy()
    z[:, 1] = wrap(z[:, 1])
    wrapped, raw = robot(), robot()
    for command, measured in zip(u, z, strict=True):
        for filter in (wrapped, raw):
            filter.predict(command, DT)
        wrapped.update(measured)
        raw.update(measured, angles=())
    assert abs(wrapped.x[2] - states[-1, 2]) < 0.3 < abs(raw.x[2] - states[-1, 2])
    assert wrapped.x[2] > 2 * np.pi


def test_the_covariance_stays_symmetric_and_positive_under_extreme_noise():
    filter = kalman.KalmanFilter(
        np.eye(3), None, np.zeros((3, 3)), None, np.zeros(3), 1e6 * np.eye(3)
    )
    rng = np.random.default_rng(4)
    P = filter.P
    for _ in range(200):
        row = rng.normal(size=(1, 3))
        filter.update([0.0], H=row, R=1e-9)
        P = kalman.short_form(P, kalman.gain(P, row, [[1e-9]]), row)
        assert (filter.P == filter.P.T).all()
        assert np.linalg.eigvalsh(filter.P).min() > 0
    assert np.abs(P - P.T).max() > 0, "the short form loses its symmetry on the way"


def test_histories_kept_without_copies_do_not_change():
    filter, kept, copies = robot(), [], []
    for command, measured in zip(*robot_data(5)[:2], strict=True):
        filter.predict(command, DT)
        kept.append(filter.P)
        filter.update(measured)
        kept += [filter.x, filter.P]
        copies = [*copies, *(array.copy() for array in kept[len(copies) :])]
    assert all((a == b).all() for a, b in zip(kept, copies, strict=True))


def test_f_may_write_into_its_argument():
    def careless(x, u, dt):
        x += dt
        return x

    filter = kalman.ExtendedKalmanFilter(
        careless, np.eye(1), lambda x: x, np.eye(1), [[1.0]], [[1.0]], [0.0], [[1.0]]
    )
    first = filter.x
    filter.predict(None, 0.5)
    assert first[0] == 0.0 and filter.x[0] == 0.5


# ---- unscented


def test_the_unscented_points_have_the_mean_and_the_covariance():
    rng = np.random.default_rng(5)
    x, A = rng.normal(size=4), rng.normal(size=(4, 4))
    for P in (A @ A.T, np.diag([1.0, 0.0, 2.0, 0.0])):
        filter = kalman.UnscentedKalmanFilter(
            lambda x, u, dt: x, None, np.zeros((4, 4)), None, x, P, alpha=0.5
        )
        filter.predict(None, 1.0)
        np.testing.assert_allclose(filter.x, x, atol=1e-13)
        np.testing.assert_allclose(filter.P, P, atol=1e-12)


@pytest.mark.parametrize("alpha", [0.1, 0.5, 1.0])
def test_the_unscented_filter_agrees_with_filterpy(alpha):
    u, z, _ = robot_data()
    points = filterpy.MerweScaledSigmaPoints(3, alpha, 2.0, 0.0)
    theirs = filterpy.UnscentedKalmanFilter(
        3, 2, DT, hx=to_mark, fx=lambda x, dt, u: motion(x, u, dt), points=points
    )
    theirs.x, theirs.P, theirs.Q, theirs.R = np.zeros(3), 0.05 * np.eye(3), Q3, R2
    ours = robot(kalman.UnscentedKalmanFilter, alpha=alpha)
    for command, measured in zip(u[:25], z[:25], strict=True):
        theirs.predict(u=command)
        theirs.update(measured)
        ours.predict(command, DT)
        ours.update(measured)
        np.testing.assert_allclose(ours.x, theirs.x, rtol=0, atol=1e-11)
        np.testing.assert_allclose(ours.P, theirs.P, rtol=0, atol=1e-11)


def test_the_unscented_filter_of_straight_models_is_the_kalman_filter():
    _, z = linear_data()
    unscented = kalman.UnscentedKalmanFilter(
        lambda x, u, dt: x @ F.T, lambda x: x @ H.T, Q, R, X0, P0
    )
    run(unscented, [None] * len(z), z)
    linear = run(kalman.KalmanFilter(F, H, Q, R, X0, P0), [None] * len(z), z)
    np.testing.assert_allclose(unscented.x, linear.x, rtol=0, atol=1e-11)
    np.testing.assert_allclose(unscented.P, linear.P, rtol=0, atol=1e-11)


def test_the_unscented_mean_of_a_turn_is_better_than_the_extended_one():
    P = np.diag([1e-6, 1e-6, 0.3])
    extended, unscented = robot(), robot(kalman.UnscentedKalmanFilter, alpha=1.0)
    for filter in (extended, unscented):
        filter.P = P
        filter.predict(np.array([10.0, 0.0]), 1.0)
    exact = 10 * np.exp(-0.15)
    assert abs(unscented.x[0] - exact) < 0.05 * abs(extended.x[0] - exact)


# ---- many at once


def test_a_batch_has_the_numbers_of_each_filter_alone():
    runs, steps = 7, 60
    data = [robot_data(steps, seed)[:2] for seed in range(runs)]
    u, z = (np.stack([d[i] for d in data], axis=1) for i in range(2))
    batch = kalman.BatchExtendedKalmanFilter(
        motion, motion_jacobian, to_mark, to_mark_jacobian, Q3, R2, np.zeros((runs, 3)),
        0.05 * np.eye(3), angles=(2,), measurement_angles=(1,),
    )  # fmt: skip
    history = kalman.History(batch)
    for k in range(steps):
        batch.predict(u[k], DT)
        batch.update(z[k])
        history.add()
    for i in range(runs):
        alone = robot()
        own = kalman.History(alone)
        for k in range(steps):
            alone.predict(u[k, i], DT)
            alone.update(z[k, i])
            own.add()
        np.testing.assert_allclose(history.x[i], own.x, rtol=0, atol=1e-12)
        np.testing.assert_allclose(history.P[i], own.P, rtol=0, atol=1e-12)
        assert batch.nis[i] == pytest.approx(alone.nis, abs=1e-12)
        together, single = kalman.rts_smoother(history), kalman.rts_smoother(own)
        np.testing.assert_allclose(together.x[i], single.x, rtol=0, atol=1e-11)


def test_a_batch_takes_one_input_one_matrix_and_another_sensor_for_all():
    runs = 4
    start = np.random.default_rng(6).normal(size=(runs, 2))
    batch = kalman.BatchExtendedKalmanFilter(
        lambda x, u, dt: x @ F.T + B @ u, F, None, H, lambda x, u, dt: Q, R, start, P0
    )
    batch.predict(np.array([0.4]), DT)
    batch.update(np.full((runs, 1), 0.3))
    batch.update(np.full((runs, 2), 0.1), H=np.eye(2), R=np.eye(2))
    for i in range(runs):
        alone = kalman.KalmanFilter(F, H, Q, R, start[i], P0, B=B)
        alone.predict([0.4], DT)
        alone.update([0.3])
        alone.update([0.1, 0.1], H=np.eye(2), R=np.eye(2))
        np.testing.assert_allclose(batch.x[i], alone.x, rtol=0, atol=1e-13)
        np.testing.assert_allclose(batch.P[i], alone.P, rtol=0, atol=1e-13)


def test_a_batch_without_derivatives_takes_differences_as_each_filter_alone():
    u, z, _ = robot_data(3)
    x0 = np.array([[0.0, 0.0, 0.0], [0.5, -0.2, 0.1]])
    models = motion, None, to_mark, None, Q3, R2
    batch = kalman.BatchExtendedKalmanFilter(*models, x0, 0.05 * np.eye(3), angles=(2,))
    for i in range(2):
        alone = kalman.ExtendedKalmanFilter(*models, x0[i], 0.05 * np.eye(3), angles=(2,))
        alone.predict(u[i], DT)
        alone.update(z[i])
        if i == 0:
            batch.predict(u[:2], DT)
            batch.update(z[:2])
        np.testing.assert_allclose(batch.x[i], alone.x, rtol=0, atol=1e-9)
        np.testing.assert_allclose(batch.P[i], alone.P, rtol=0, atol=1e-9)


# ---- the compiled arithmetic


@pytest.mark.parametrize(("n", "m"), [(1, 1), (3, 2), (6, 6), (2, 4)])
def test_the_engine_is_the_equations(n, m):
    rng, N = np.random.default_rng(n + 10 * m), 5
    x, y, H = rng.normal(size=(N, n)), rng.normal(size=(N, m)), rng.normal(size=(N, m, n))
    F, P, Q, R = (
        A @ np.swapaxes(A, -1, -2) + 0.1 * np.eye(A.shape[-1])
        for A in (rng.normal(size=(N, size, size)) for size in (n, n, n, m))
    )
    F = F + rng.normal(size=F.shape)
    rows = [np.array(np.moveaxis(v, 0, -1), order="C") for v in (x, F, P, Q, y, H, R)]
    P_prior, S = np.empty((n, n, N)), np.empty((m, m, N))
    engine.propagate(rows[1], rows[2], rows[3], P_prior)
    np.testing.assert_allclose(
        np.moveaxis(P_prior, -1, 0), F @ P @ np.swapaxes(F, -1, -2) + Q, rtol=1e-12, atol=1e-12
    )
    x_new, P_new, K, nis = np.empty((n, N)), np.empty((n, n, N)), np.empty((n, m, N)), np.empty(N)
    engine.correct(rows[0], rows[2], *rows[4:], x_new, P_new, S, K, nis)
    for i in range(N):
        expected = kalman.update(x[i], P[i], y[i] + H[i] @ x[i], H[i], R[i])
        np.testing.assert_allclose(x_new[:, i], expected[0], rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(P_new[..., i], expected[1], rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(K[..., i], kalman.gain(P[i], H[i], R[i]), atol=1e-12)
        assert nis[i] == pytest.approx(kalman.nis(y[i], H[i] @ P[i] @ H[i].T + R[i]), rel=1e-12)


def test_the_engines_root_is_choleskys_and_a_zero_variance_has_a_zero_column():
    A = np.random.default_rng(8).normal(size=(4, 4))
    singular = np.diag([1.0, 0.0, 4.0, 0.0])
    P = np.stack([A @ A.T, singular, -np.eye(4)], axis=-1)
    L = engine.root(P)
    np.testing.assert_allclose(L[..., 0], np.linalg.cholesky(P[..., 0]), atol=1e-12)
    np.testing.assert_array_equal(L[..., 1], np.sqrt(singular))
    assert np.isnan(L[..., 2].diagonal()).all()


# ---- what no measurement shows


def test_position_needs_more_than_the_heading_and_a_landmark_needs_the_heading():
    u = np.array([1.0, 0.3])
    x, Fs, Hs = np.zeros(3), [], []
    for _ in range(20):
        Hs.append(to_mark_jacobian(x))
        Fs.append(motion_jacobian(x, u, DT))
        x = motion(x, u, DT)
    yaw, Fs = np.tile([[[0.0, 0.0, 1.0]]], (20, 1, 1)), np.array(Fs[:-1])
    blind = kalman.unobservable(Fs, yaw)
    assert blind.shape == (3, 2)
    np.testing.assert_allclose(blind[2], 0, atol=1e-12)
    one_mark = kalman.unobservable(Fs, Hs)
    assert one_mark.shape == (3, 1), "the world may turn about the landmark"
    about = np.array([MARK[1], -MARK[0], 1.0])
    np.testing.assert_allclose(np.cross(one_mark[:, 0], about), 0, atol=1e-9)
    assert kalman.unobservable(Fs, np.concatenate([Hs, yaw], axis=1)).shape == (3, 0)


def test_along_a_blind_direction_the_variance_only_grows():
    filter = kalman.ExtendedKalmanFilter(
        motion,
        motion_jacobian,
        None,
        [[0.0, 0.0, 1.0]],
        Q3,
        [[1e-4]],
        np.zeros(3),
        1e-4 * np.eye(3),
    )
    spread = []
    for _ in range(300):
        filter.predict(np.array([1.0, 0.0]), DT)
        filter.update([0.0])
        spread.append(np.linalg.eigvalsh(filter.P[:2, :2]).min())
    assert (np.diff(spread) > 0).all()
