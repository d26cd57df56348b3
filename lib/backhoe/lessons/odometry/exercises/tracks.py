"""Exercise 6.8: the part `odometry` of the machine, a pose from a pose and two sprocket rates."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE

_RADIUS = BACKHOE.tracks.sprocket_radius


def odometry(pose: NDArray, left: float, right: float, dt: float, gauge: float) -> NDArray:
    """The next pose from sprocket rates held for dt, shape (3,) [m, m, rad]."""
    way = _RADIUS * (left + right) / 2 * dt
    turn = _RADIUS * (right - left) / gauge * dt
    middle = pose[2] + turn / 2
    return pose + np.array([way * np.cos(middle), way * np.sin(middle), turn])


def _steps(rng: np.random.Generator) -> list[tuple]:
    low, high = (-6.0, -6.0, 0.01, 1.6), (6.0, 6.0, 0.05, 3.2)
    cases = [(rng.uniform(-9, 9, 3), *map(float, rng.uniform(low, high))) for _ in range(30)]
    return [*cases, (np.array([1.0, 2.0, 7.0]), 3.0, 3.0, 0.02, 2.0)]


def _moved(pose: NDArray, way: float, turn: float, share: float = 0.5) -> NDArray:
    heading = pose[2] + share * turn
    return np.array(
        [pose[0] + way * np.cos(heading), pose[1] + way * np.sin(heading), pose[2] + turn]
    )


def _with(scale_way: float = 1.0, scale_turn: float = 1.0, share: float = 0.5) -> object:
    def wrong(pose: NDArray, left: float, right: float, dt: float, gauge: float) -> NDArray:
        way = scale_way * _RADIUS * (left + right) / 2 * dt
        return _moved(pose, way, scale_turn * _RADIUS * (right - left) / gauge * dt, share)

    return wrong


def _no_time_step(pose: NDArray, left: float, right: float, dt: float, gauge: float) -> NDArray:
    return odometry(pose, left, right, 1.0, gauge)


def _divided(pose: NDArray, left: float, right: float, dt: float, gauge: float) -> NDArray:
    v, omega = _RADIUS * (left + right) / 2, _RADIUS * (right - left) / gauge
    end = pose[2] + omega * dt
    with np.errstate(all="ignore"):
        bend = np.float64(v) / omega
    way = bend * (np.sin(end) - np.sin(pose[2])), bend * (np.cos(pose[2]) - np.cos(end))
    return np.array([pose[0] + way[0], pose[1] + way[1], end])


def _wrapped(pose: NDArray, left: float, right: float, dt: float, gauge: float) -> NDArray:
    x, y, psi = odometry(pose, left, right, dt, gauge)
    return np.array([x, y, np.arctan2(np.sin(psi), np.cos(psi))])


def _swapped_sines(pose: NDArray, left: float, right: float, dt: float, gauge: float) -> NDArray:
    x, y, psi = odometry(pose, left, right, dt, gauge)
    return np.array([pose[0] + (y - pose[1]), pose[1] + (x - pose[0]), psi])


ODOMETRY = Exercise(
    number="6.8",
    title="Odometry for the machine",
    reference=odometry,
    cases=_steps,
    atol=2e-6,
    mistakes={
        "left and right are swapped: a faster right track turns the machine to the left": (
            lambda pose, left, right, dt, gauge: odometry(pose, right, left, dt, gauge)
        ),
        "it turns twice as much: (2.9) divides by the whole gauge, not by half of it": (
            _with(scale_turn=2.0)
        ),
        "it turns half as much: divide the difference by the gauge, once": _with(scale_turn=0.5),
        "it turns with the gauge of the drawing: use the one that you are given": (
            lambda pose, left, right, dt, gauge: odometry(
                pose, left, right, dt, BACKHOE.tracks.gauge
            )
        ),
        "sprockets turn in rad/s, belts run at r times that: the radius is missing": (
            _with(1 / _RADIUS, 1 / _RADIUS)
        ),
        "twice too far: the middle moves with the mean of the two tracks": _with(scale_way=2.0),
        "these are rates: what moves in a step is the rate times dt": _no_time_step,
        "Euler, along the heading of the start: take the middle of the step, or the arc": (
            _with(share=0.0)
        ),
        "that is (4.1) as printed, along the heading of the end: take the middle, or the arc": (
            _with(share=1.0)
        ),
        "that is how far it moved in the step: add it to the pose": (
            lambda pose, *given: odometry(pose, *given) - pose
        ),
        "it divides by omega = 0 when both tracks run alike": _divided,
        "sine and cosine are swapped: at psi = 0 the machine moves along x": _swapped_sines,
        "the heading is wrapped: let it count on through full turns": _wrapped,
    },
    hints=(
        "First way and turn of the step, from (2.9) times dt; then move along psi + turn / 2.",
        "way = r (left + right) / 2 dt, turn = r (right - left) / gauge dt, r of the sprocket.",
    ),
    tested_on="31 random steps of 10 to 50 ms, forwards, backwards and straight ahead",
)
