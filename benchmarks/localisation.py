"""Extended Kalman filters against FilterPy: same models, same answers, ratio of times.

A vehicle with odometry as input and the yaw of an inertial unit as measurement, 30 cycles per
second: one filter step by step in both, then 1000 runs of 100 s in one batch. Both sides call the
same functions f, F, h and H for one filter, written for floats as one would without a batch; the
batch has them over leading axes. Ratios are of the best of several rounds in turn.

Exit code 1 when a limit is missed or an answer differs by more than 1e-12.
"""

from __future__ import annotations

import sys
from math import cos, sin
from time import perf_counter

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from backhoe.localisation import kalman

RUNS, CYCLES, DT = 1000, 3000, 1 / 30
ROUNDS, STEPS = 7, 1000
SINGLE_LIMIT, BATCH_LIMIT, SAME = 0.5, 0.02, 1e-12

Q, R = np.diag([1e-5, 1e-5, 1e-6]), np.array([[4e-4]])
X0, P0 = np.zeros(3), 1e-4 * np.eye(3)
H = np.array([[0.0, 0.0, 1.0]])


def move(x: np.ndarray, u: np.ndarray, dt: float) -> np.ndarray:
    """The arc's chord at the mean heading."""
    px, py, psi = x.tolist()
    v, omega = u.tolist()
    heading = psi + omega * dt / 2
    return np.array([px + v * dt * cos(heading), py + v * dt * sin(heading), psi + omega * dt])


def jacobian(x: np.ndarray, u: np.ndarray, dt: float) -> np.ndarray:
    v, omega = u.tolist()
    heading = float(x[2]) + omega * dt / 2
    return np.array(
        [[1.0, 0.0, -v * dt * sin(heading)], [0.0, 1.0, v * dt * cos(heading)], [0.0, 0.0, 1.0]]
    )


def yaw(x: np.ndarray) -> np.ndarray:
    return x[2:]


def move_all(x: np.ndarray, u: np.ndarray, dt: float) -> np.ndarray:
    heading = x[:, 2] + u[:, 1] * (dt / 2)
    step = u[:, 0] * dt
    moved = np.empty_like(x)
    moved[:, 0] = x[:, 0] + step * np.cos(heading)
    moved[:, 1] = x[:, 1] + step * np.sin(heading)
    moved[:, 2] = x[:, 2] + u[:, 1] * dt
    return moved


def jacobian_all(x: np.ndarray, u: np.ndarray, dt: float) -> np.ndarray:
    heading = x[:, 2] + u[:, 1] * (dt / 2)
    step = u[:, 0] * dt
    F = np.zeros((len(x), 3, 3))
    F[:, 0, 0] = F[:, 1, 1] = F[:, 2, 2] = 1.0
    F[:, 0, 2] = -step * np.sin(heading)
    F[:, 1, 2] = step * np.cos(heading)
    return F


def yaw_all(x: np.ndarray) -> np.ndarray:
    return x[:, 2:]


class Peer(ExtendedKalmanFilter):
    """FilterPy's filter with a curved motion, as its documentation has one do it."""

    def predict_x(self, u: np.ndarray = X0) -> None:
        self.x = move(self.x, u, DT)


def peer(u: np.ndarray, z: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    filter = Peer(3, 1)
    filter.x, filter.P, filter.Q, filter.R = X0.copy(), P0.copy(), Q, R
    start = perf_counter()
    for command, measured in zip(u, z, strict=True):
        filter.F = jacobian(filter.x, command, DT)
        filter.predict(command)
        filter.update(measured, lambda x: H, yaw)
    return perf_counter() - start, filter.x, filter.P


def single(u: np.ndarray, z: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    filter = kalman.ExtendedKalmanFilter(move, jacobian, yaw, H, Q, R, X0, P0, angles=(2,))
    start = perf_counter()
    for command, measured in zip(u, z, strict=True):
        filter.predict(command, DT)
        filter.update(measured)
    return perf_counter() - start, filter.x, filter.P


def batch(u: np.ndarray, z: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    filter = kalman.BatchExtendedKalmanFilter(
        move_all, jacobian_all, yaw_all, H, Q, R, np.zeros((u.shape[1], 3)), P0, angles=(2,)
    )
    start = perf_counter()
    for command, measured in zip(u, z, strict=True):
        filter.predict(command, DT)
        filter.update(measured)
    return perf_counter() - start, filter.x, filter.P


def report(what: str, figure: float, unit: str, limit: float) -> bool:
    verdict = "ok" if figure <= limit else "MISSED"
    print(f"{what:58s} {figure:9.3g} {unit:5s} limit {limit:<6g} {verdict}")
    return figure <= limit


def main() -> int:
    rng = np.random.default_rng(0)
    u = rng.normal([0.5, 0.2], [0.1, 0.1], (CYCLES, RUNS, 2))
    z = DT * np.cumsum(u[..., 1:], axis=0) + 0.02 * rng.standard_normal((CYCLES, RUNS, 1))
    batch(u[:2], z[:2])
    few = u[:STEPS, 0].copy(), z[:STEPS, 0].copy()
    single(few[0][:2], few[1][:2])
    times = {peer: [], single: [], batch: []}
    for _ in range(ROUNDS):
        for way in (peer, single):
            times[way].append(way(*few)[0] / STEPS)
        times[batch].append(batch(u[:300], z[:300])[0] / 300 / RUNS)
    one, ours, many = (1e6 * min(times[way]) for way in (peer, single, batch))
    whole, x, P = batch(u, z)
    print(f"a cycle: FilterPy {one:.1f} us, one filter {ours:.1f} us, of {RUNS} {many:.3f} us")
    print(f"{RUNS} runs of {CYCLES * DT:.0f} s at {1 / DT:.0f} Hz: {whole:.2f} s")
    apart = 0.0
    for run in (0, RUNS - 1):
        data = u[:, run].copy(), z[:, run].copy()
        theirs, alone = peer(*data), single(*data)
        for a, b in ((theirs[1:], alone[1:]), (theirs[1:], (x[run], P[run]))):
            apart = max(apart, *(float(np.abs(p - q).max()) for p, q in zip(a, b, strict=True)))
    lines = [
        report("largest difference from FilterPy [m, rad]", apart, "", SAME),
        report("one filter over FilterPy", ours / one, "", SINGLE_LIMIT),
        report(f"a cycle of {RUNS} runs together over FilterPy", many / one, "", BATCH_LIMIT),
    ]
    return 0 if all(lines) else 1


if __name__ == "__main__":
    sys.exit(main())
