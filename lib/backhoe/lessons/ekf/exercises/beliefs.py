"""Exercises 7.1 and 7.2: a step of a Bayes filter over places, the update of a Kalman filter."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.localisation import kalman


def bayes(belief: NDArray, transition: NDArray, likelihood: NDArray) -> NDArray:
    """Belief after a move and a measurement, shape (n,): (4.7) with its marginals."""
    moved = transition @ belief
    joint = likelihood * moved
    return joint / joint.sum()


def _beliefs(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for n in rng.integers(3, 9, 30):
        belief, transition = rng.uniform(0.05, 1.0, n), rng.uniform(0.05, 1.0, (n, n))
        cases.append((_sum_1(belief), transition / transition.sum(0), rng.uniform(0.05, 1.0, n)))
    walk = np.array([[0.1, 0, 0], [0.9, 0.2, 0], [0, 0.8, 1]])  # and a place that is sure
    cases.append((np.array([0.0, 1.0, 0.0]), walk, np.array([0.5, 0.0, 0.7])))
    cases.append((np.array([0.5, 0.5, 0.0]), np.eye(3), np.array([0.2, 0.2, 0.9])))
    return cases


def _sum_1(joint: NDArray) -> NDArray:
    return joint / joint.sum()


BAYES = Exercise(
    number="7.1",
    title="One step of a Bayes filter",
    reference=bayes,
    cases=_beliefs,
    oracle="every_way_to_each_place",
    mistakes={
        "the transition is transposed: row i, column j is from j to i": (
            lambda belief, T, likely: bayes(belief, T.T, likely)
        ),
        "it does not sum to 1: the evidence P(z_k | z_1:k-1) is missing": (
            lambda belief, T, likely: likely * (T @ belief)
        ),
        "the measurement comes before the move: it was taken at the new place": (
            lambda belief, T, likely: T @ _sum_1(likely * belief)
        ),
        "the machine has not moved: carry the belief through the transition first": (
            lambda belief, T, likely: _sum_1(likely * belief)
        ),
        "that is the prediction alone: the likelihood is not used": (
            lambda belief, T, likely: T @ belief
        ),
        "that forgets all that was known before: multiply by the predicted belief": (
            lambda belief, T, likely: _sum_1(likely)
        ),
        "likelihood and prediction are added: (4.4) multiplies them": (
            lambda belief, T, likely: _sum_1(likely + T @ belief)
        ),
        "only the likeliest place before the move counts: sum over all of them": (
            lambda belief, T, likely: _sum_1(likely * T[:, np.argmax(belief)])
        ),
        "the likelihood is squared: one measurement counts once": (
            lambda belief, T, likely: _sum_1(likely**2 * (T @ belief))
        ),
        "the machine has moved twice: one step": (
            lambda belief, T, likely: _sum_1(likely * (T @ T @ belief))
        ),
        "of each way only the likeliest counts: add the ways to a place": (
            lambda belief, T, likely: _sum_1(likely * (T * belief).max(axis=1))
        ),
        "the old belief is multiplied in once more: the predicted one holds it already": (
            lambda belief, T, likely: _sum_1(likely * belief * (T @ belief))
        ),
        "the measurement comes before the move, and it does not sum to 1": (
            lambda belief, T, likely: T @ (likely * belief)
        ),
        "the machine has not moved, and it does not sum to 1: predict first, divide at the end": (
            lambda belief, T, likely: likely * belief
        ),
        "it is divided by the sum of the likelihoods: divide by the sum of the products": (
            lambda belief, T, likely: likely * (T @ belief) / likely.sum()
        ),
        "it is divided by the number of places: divide by the sum": (
            lambda belief, T, likely: likely * (T @ belief) / len(belief)
        ),
        "it is divided by the root of the sum of squares: divide by the sum": (
            lambda belief, T, likely: likely * (T @ belief) / np.linalg.norm(likely * (T @ belief))
        ),
        "that is the belief before the move and the measurement": (
            lambda belief, T, likely: belief
        ),
        "that is the likelihood: multiply it by what was predicted": (
            lambda belief, T, likely: likely
        ),
        "1 - likelihood is that of not seeing it: take the likelihood as it comes": (
            lambda belief, T, likely: _sum_1((1 - likely) * (T @ belief))
        ),
        "it is divided by the largest value: divide by the sum": (
            lambda belief, T, likely: likely * (T @ belief) / (likely * (T @ belief)).max()
        ),
    },
    hints=(
        "Predict: for each place, the sum over all places that the machine may have come from.",
        "transition @ belief, times likelihood element by element, divided by the sum of that.",
    ),
    tested_on="32 beliefs of three to eight places, some of them sure",
)


def _spd(rng: np.random.Generator, n: int) -> NDArray:
    A = rng.normal(size=(n, n))
    return A @ A.T + 0.3 * np.eye(n)


def _filters(rng: np.random.Generator) -> list[tuple]:
    """Filters with fewer measurements than states, and some with as many."""
    sizes = [*rng.integers((3, 1), (6, 3), (20, 2)), *np.repeat(rng.integers(2, 4, (10, 1)), 2, 1)]
    cases = []
    for n, m in sizes:
        x, z, H = rng.normal(size=n), rng.normal(size=m), rng.normal(size=(m, n))
        cases.append((x, _spd(rng, n), z, H, _spd(rng, m)))
    return cases


def _by(gain: Callable) -> Callable:
    """An update by another gain, with the short form of the covariance."""

    def answer(x: NDArray, P: NDArray, z: NDArray, H: NDArray, R: NDArray) -> tuple:
        K = gain(P, H, R)
        return x + K @ (z - H @ x), kalman.short_form(P, K, H)

    return answer


def _spoilt(spoil: Callable) -> Callable:
    """What spoil(right x, right P, x, P, z, R, K) makes of a right update."""

    def answer(x: NDArray, P: NDArray, z: NDArray, H: NDArray, R: NDArray) -> tuple:
        return spoil(*kalman.update(x, P, z, H, R), x, P, z, R, kalman.gain(P, H, R))

    return answer


UPDATE = Exercise(
    number="7.2",
    title="The update of a Kalman filter",
    reference=kalman.update,
    cases=_filters,
    oracle="the_joint_normal_conditioned",
    mistakes={
        "H is transposed: K = P H^T S^-1 and S = H P H^T + R, with H as it is given, (m, n)": (
            lambda x, P, z, H, R: kalman.update(x, P, z, H.T, R)
        ),
        "the state is right, the covariance is still the old one: (4.19) is missing": (
            _spoilt(lambda new, P_new, x, P, z, R, K: (new, P))
        ),
        "K = P H^T R^-1 forgets that the prediction is uncertain too: invert H P H^T + R": (
            _by(lambda P, H, R: P @ H.T @ np.linalg.inv(R))
        ),
        "R is not used: the measurement is believed as if it had no noise": (
            _by(lambda P, H, R: kalman.gain(P, H, 0 * R))
        ),
        "the state moves away from the measurement: the innovation is z - H x": (
            _spoilt(lambda new, P_new, x, P, z, R, K: (2 * x - new, P_new))
        ),
        "R is squared: it is a covariance already, not a standard deviation": (
            lambda x, P, z, H, R: kalman.update(x, P, z, H, R @ R)
        ),
        "R holds variances: you have taken their roots": (
            lambda x, P, z, H, R: kalman.update(x, P, z, H, np.diag(np.sqrt(np.diag(R))))
        ),
        "the covariance grows by a measurement: I - K H, with a minus": (
            _spoilt(lambda new, P_new, x, P, z, R, K: (new, 2 * P - P_new))
        ),
        "K R K^T is missing in Joseph's form: the measurement's noise gets into the state": (
            _spoilt(lambda new, P_new, x, P, z, R, K: (new, P_new - K @ R @ K.T))
        ),
        "the covariance is that of R alone: I - K H of P": (
            _spoilt(lambda new, P_new, x, P, z, R, K: (new, K @ R @ K.T))
        ),
        "Joseph's form has R where K R K^T belongs": (
            _spoilt(
                lambda new, P_new, x, P, z, R, K: (
                    (new, P_new - K @ R @ K.T + R)
                    if R.shape == P.shape
                    else (new, P_new - K @ R @ K.T + R.sum())
                )
            )
        ),
        "S is not inverted: K = P H^T S^-1": _by(lambda P, H, R: P @ H.T @ (H @ P @ H.T + R)),
        "only the variances of S are inverted: take np.linalg.inv of all of it": (
            _by(lambda P, H, R: P @ H.T / np.diag(H @ P @ H.T + R))
        ),
        "R is subtracted in S: the sensor's noise adds to H P H^T": (
            _by(lambda P, H, R: P @ H.T @ np.linalg.inv(H @ P @ H.T - R))
        ),
        "P is missing in the gain: K = P H^T S^-1": (
            _by(lambda P, H, R: H.T @ np.linalg.inv(H @ P @ H.T + R))
        ),
        "the order is turned round: (I - K H) P, with P on the right": (
            _spoilt(lambda new, P_new, x, P, z, R, K: (new, P @ P_new @ np.linalg.inv(P)))
        ),
        "K R K^T is subtracted from P: what a measurement takes off is K S K^T": (
            _spoilt(lambda new, P_new, x, P, z, R, K: (new, P - K @ R @ K.T))
        ),
        "that is what the measurement takes off P: P less that": (
            _spoilt(lambda new, P_new, x, P, z, R, K: (new, P - P_new))
        ),
        "P is missing behind I - K H": (
            _spoilt(lambda new, P_new, x, P, z, R, K: (new, P_new @ np.linalg.inv(P)))
        ),
        "the state is the step K (z - H x) alone: add it to x": (
            _spoilt(lambda new, P_new, x, P, z, R, K: (new - x, P_new))
        ),
        "the prior's covariance is not used in S: S = H P H^T + R": (
            _by(lambda P, H, R: P @ H.T @ np.linalg.inv(H @ H.T + R))
        ),
        "only the variances of P are used: what errs together is in the others": (
            lambda x, P, z, H, R: kalman.update(x, np.diag(np.diag(P)), z, H, R)
        ),
        "the whole measurement is added: only what is new, z - H x, counts": (
            _spoilt(lambda new, P_new, x, P, z, R, K: (x + K @ z, P_new))
        ),
    },
    hints=(
        "S = H P H^T + R is how uncertain the innovation is; K = P H^T S^-1.",
        "x + K (z - H x), and (I - K H) P for this K: mind the order, (n, m) times (m, n).",
    ),
    tested_on="30 random filters, ten of them with as many measurements as states",
)
