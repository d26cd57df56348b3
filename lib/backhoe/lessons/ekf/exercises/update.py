"""Exercise 7.2: the update of a Kalman filter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise


def update(x: NDArray, P: NDArray, z: NDArray, H: NDArray, R: NDArray) -> tuple[NDArray, NDArray]:
    """State (n,) and covariance (n, n) after a measurement: (4.16), (4.17), (4.19)."""
    K = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
    A = np.eye(len(x)) - K @ H
    return x + K @ (z - H @ x), A @ P @ A.T + K @ R @ K.T


def _spd(rng: np.random.Generator, n: int) -> NDArray:
    A = rng.normal(size=(n, n))
    return A @ A.T + 0.3 * np.eye(n)


def _cases(rng: np.random.Generator) -> list[tuple]:
    """Filters with fewer measurements than states, and some with as many."""
    sizes = [*rng.integers((3, 1), (6, 3), (20, 2)), *np.repeat(rng.integers(2, 4, (10, 1)), 2, 1)]
    cases = []
    for n, m in sizes:
        x, z, H = rng.normal(size=n), rng.normal(size=m), rng.normal(size=(m, n))
        cases.append((x, _spd(rng, n), z, H, _spd(rng, m)))
    return cases


def _transposed(
    x: NDArray, P: NDArray, z: NDArray, H: NDArray, R: NDArray
) -> tuple[NDArray, NDArray]:
    """With H^T for H, where it fits; no numbers where it does not."""
    if H.shape[0] == H.shape[1]:
        return update(x, P, z, H.T, R)
    return np.full_like(x, np.nan), np.full_like(P, np.nan)


def _by(gain: object) -> object:
    """An update by another gain, with the short form of the covariance."""

    def answer(
        x: NDArray, P: NDArray, z: NDArray, H: NDArray, R: NDArray
    ) -> tuple[NDArray, NDArray]:
        K = gain(P, H, R)
        return x + K @ (z - H @ x), (np.eye(len(x)) - K @ H) @ P

    return answer


UPDATE = Exercise(
    number="7.2",
    title="The update of a Kalman filter",
    reference=update,
    cases=_cases,
    mistakes={
        "H is transposed: K = P H^T S^-1 and S = H P H^T + R, with H as it is given, (m, n)": (
            _transposed
        ),
        "the state is right, the covariance is still the old one: (4.19) is missing": (
            lambda x, P, z, H, R: (update(x, P, z, H, R)[0], P)
        ),
        "K = P H^T R^-1 forgets that the prediction is uncertain too: invert H P H^T + R": (
            _by(lambda P, H, R: P @ H.T @ np.linalg.inv(R))
        ),
        "R is not used: the measurement is believed as if it had no noise": (
            _by(lambda P, H, R: P @ H.T @ np.linalg.inv(H @ P @ H.T))
        ),
        "the state moves away from the measurement: the innovation is z - H x": (
            lambda x, P, z, H, R: (2 * x - update(x, P, z, H, R)[0], update(x, P, z, H, R)[1])
        ),
        "R is squared: it is a covariance already, not a standard deviation": (
            lambda x, P, z, H, R: update(x, P, z, H, R @ R)
        ),
        "R holds variances: you have taken their roots": (
            lambda x, P, z, H, R: update(x, P, z, H, np.diag(np.sqrt(np.diag(R))))
        ),
        "the covariance grows by a measurement: I - K H, with a minus": (
            lambda x, P, z, H, R: (
                update(x, P, z, H, R)[0],
                2 * P - update(x, P, z, H, R)[1],
            )
        ),
        "K R K^T is missing in Joseph's form: the measurement's noise gets into the state": (
            lambda x, P, z, H, R: (
                update(x, P, z, H, R)[0],
                update(x, P, z, H, R)[1] - _last_term(P, H, R),
            )
        ),
        "the whole measurement is added: only what is new, z - H x, counts": (
            lambda x, P, z, H, R: (
                x + P @ H.T @ np.linalg.inv(H @ P @ H.T + R) @ z,
                update(x, P, z, H, R)[1],
            )
        ),
    },
    hints=(
        "S = H P H^T + R is how uncertain the innovation is; K = P H^T S^-1.",
        "x + K (z - H x), and (I - K H) P for this K: mind the order, (n, m) times (m, n).",
    ),
    tested_on="30 random filters, ten of them with as many measurements as states",
)


def _last_term(P: NDArray, H: NDArray, R: NDArray) -> NDArray:
    K = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
    return K @ R @ K.T
