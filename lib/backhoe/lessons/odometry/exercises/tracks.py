"""Exercise 6.8: the part `odometry` of the machine, a pose from a pose and two sprocket rates."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.angles import wrap
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.odometry.exercises.steps import by_differences
from backhoe.machine import BACKHOE
from backhoe.vehicle.tracks import tracks_twist

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
    pose = np.array([1.0, 2.0, 7.0])
    others = ((3.0, 3.0), (-3.0, -3.0), (-2.0, 2.0), (0.0, 0.0))
    return [*cases, *((pose, *rates, 0.03, 2.0) for rates in others)]


def _along(pose: NDArray, way: float, turn: float, heading: str = "middle") -> NDArray:
    """The pose after a way and a turn, along the heading of the start, middle or end, or an arc."""
    share = {"start": 0.0, "end": 1.0}.get(heading, 0.5)
    chord = way * np.sinc(turn / 2 / np.pi) if heading == "arc" else way
    to = pose[2] + share * turn
    return pose + np.array([chord * np.cos(to), chord * np.sin(to), turn])


_SMALL = (
    "left and right are swapped",
    "it turns half as much",
    "it turns with the gauge of the drawing",
    "a step has its own length",
    "in reverse it goes ahead",
    "it turns to one side only",
)
"""With these the turn of a step stays small: a chord in place of an arc is not seen."""

_WAYS_AND_TURNS = {
    "left and right are swapped: a faster right track turns the machine to the left": (
        lambda way, turn, dt, gauge: (way, -turn)
    ),
    "it turns twice as much: divide by the whole gauge, not by half of it": (
        lambda way, turn, dt, gauge: (way, 2 * turn)
    ),
    "it turns half as much: divide the difference by the gauge, once": (
        lambda way, turn, dt, gauge: (way, turn / 2)
    ),
    "it turns with the gauge of the drawing: use the one that you are given": (
        lambda way, turn, dt, gauge: (way, turn * gauge / BACKHOE.tracks.gauge)
    ),
    "the gauge is missing: a difference of ways is no angle yet": (
        lambda way, turn, dt, gauge: (way, turn * gauge)
    ),
    "sprockets turn in rad/s, belts run at r times that: the radius is missing": (
        lambda way, turn, dt, gauge: (way / _RADIUS, turn / _RADIUS)
    ),
    "the radius is missing in the turn": lambda way, turn, dt, gauge: (way, turn / _RADIUS),
    "the radius is missing in the way": lambda way, turn, dt, gauge: (way / _RADIUS, turn),
    "twice too far: the middle moves with the mean of the two tracks, not with their sum": (
        lambda way, turn, dt, gauge: (2 * way, turn)
    ),
    "these are rates: what moves in a step is the rate times dt": (
        lambda way, turn, dt, gauge: (way / dt, turn / dt)
    ),
    "dt is missing in the turn": lambda way, turn, dt, gauge: (way, turn / dt),
    "dt is missing in the way": lambda way, turn, dt, gauge: (way / dt, turn),
    "a step has its own length: use dt, not 0.02 s": (
        lambda way, turn, dt, gauge: (0.02 * way / dt, 0.02 * turn / dt)
    ),
    "the turn is in degrees: the heading is in radians": (
        lambda way, turn, dt, gauge: (way, np.degrees(turn))
    ),
    "in reverse it goes ahead: rates have a sign": (lambda way, turn, dt, gauge: (abs(way), turn)),
    "it turns to one side only: the difference has a sign": (
        lambda way, turn, dt, gauge: (way, abs(turn))
    ),
}

_LAID = {
    "middle": "{}",
    "arc": "{} (the arc itself is right)",
    "start": "{}; and the way points along the middle heading, not along the old one",
    "end": "{}; and the way points along the middle heading, not along the new one",
}


def _laid(change: Callable, heading: str) -> Callable[..., NDArray]:
    def answer(pose: NDArray, left: float, right: float, dt: float, gauge: float) -> NDArray:
        way, turn = _RADIUS * (left + right) / 2 * dt, _RADIUS * (right - left) / gauge * dt
        return _along(pose, *change(way, turn, dt, gauge), heading)

    return answer


def _swapped_axes(heading: str) -> Callable[..., NDArray]:
    laid = _laid(lambda way, turn, dt, gauge: (way, turn), heading)
    return lambda pose, *given: pose + (laid(pose, *given) - pose)[[1, 0, 2]]


ODOMETRY = Exercise(
    number="6.8",
    title="Odometry for the machine",
    reference=odometry,
    oracle="exponential_of_the_belts_twist",
    cases=_steps,
    atol=2e-6,
    mistakes={
        "Euler, along the heading of the start: take the middle of the step, or the arc": (
            _laid(lambda way, turn, dt, gauge: (way, turn), "start")
        ),
        "along the heading of the end: take the middle of the step, or the arc": (
            _laid(lambda way, turn, dt, gauge: (way, turn), "end")
        ),
        **{
            _LAID[heading].format(text): _laid(change, heading)
            for text, change in _WAYS_AND_TURNS.items()
            for heading in _LAID
            if heading != "arc" or text.split(":")[0] not in _SMALL
        },
        "that is how far it moved in the step: add it to the pose": (
            lambda pose, *given: odometry(pose, *given) - pose
        ),
        "the way goes along x, whatever the heading: turn it by psi": (
            lambda pose, left, right, dt, gauge: (
                pose
                + np.array(
                    [_RADIUS * (left + right) / 2 * dt, 0.0, _RADIUS * (right - left) / gauge * dt]
                )
            )
        ),
        "the heading does not turn: add the turn to it": (
            lambda pose, *given: np.append(odometry(pose, *given)[:2], pose[2])
        ),
        "it divides by omega = 0 when both tracks run alike": (
            lambda pose, left, right, dt, gauge: by_differences(
                pose, *map(float, tracks_twist(left, right, gauge=gauge)), dt
            )
        ),
        "sine and cosine are swapped: at psi = 0 the machine moves along x": (
            _swapped_axes("middle")
        ),
        "sine and cosine are swapped, and the heading is the old one": _swapped_axes("start"),
        "the heading is wrapped: let it count on through full turns": (
            lambda *given: np.append(odometry(*given)[:2], wrap(odometry(*given)[2]))
        ),
    },
    hints=(
        "First way and turn of the step, rates times dt; then move along psi + turn / 2.",
        "way = r (left + right) / 2 dt, turn = r (right - left) / gauge dt, r of the sprocket.",
    ),
    tested_on="34 random steps of 10 to 50 ms, forwards, in reverse, straight and on the spot",
)
