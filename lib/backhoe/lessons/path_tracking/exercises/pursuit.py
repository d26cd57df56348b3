"""Exercise 5.7: pure pursuit of a polyline."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import wrap
from backhoe.lessons.exercise import Exercise
from backhoe.vehicle.tracking import Goal, PurePursuit
from backhoe.vehicle.tracking.foot import Foot


def pure_pursuit(pose: ArrayLike, path: ArrayLike, lookahead: float, speed: float) -> NDArray:
    """v [m/s] and omega [rad/s] of the arc to the point `lookahead` ahead along the path."""
    start, way = path[:-1], np.diff(path, axis=0)
    arc = np.append(0.0, np.cumsum(np.linalg.norm(way, axis=1)))
    share = ((pose[:2] - start) * way).sum(axis=1) / (way**2).sum(axis=1)
    share = np.clip(share, 0.0, 1.0)
    near = np.linalg.norm(pose[:2] - start - share[:, None] * way, axis=1).argmin()
    ahead = arc[near] + share[near] * (arc[near + 1] - arc[near]) + lookahead
    target = np.array([np.interp(ahead, arc, path[:, 0]), np.interp(ahead, arc, path[:, 1])])
    dx, dy = target - pose[:2]
    aside = -np.sin(pose[2]) * dx + np.cos(pose[2]) * dy
    return np.array([speed, speed * 2 * aside / (dx**2 + dy**2)])


def _cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(40):
        turns = np.cumsum(rng.uniform(-0.7, 0.7, 7)) + rng.uniform(-3.0, 3.0)
        steps = rng.uniform(0.3, 1.0, 7)[:, None] * np.column_stack((np.cos(turns), np.sin(turns)))
        path = np.vstack((np.zeros(2), np.cumsum(steps, axis=0))) + rng.uniform(-2, 2, 2)
        at = rng.integers(1, 6)
        place = path[at] + rng.uniform(0.1, 0.9) * (path[at + 1] - path[at])
        pose = np.append(place + rng.uniform(-0.3, 0.3, 2), turns[at] + rng.uniform(-0.8, 0.8))
        pose[2] += 2 * np.pi * rng.integers(-1, 2)
        cases.append((pose, path, rng.uniform(0.5, 1.0), rng.uniform(0.2, 0.8)))
    straight = np.array([[-1.0, 2.0], [0.5, 2.0], [1.5, 2.0]])
    for pose in ([0.0, 2.0, 0.0], [0.0, 2.2, 0.0], [0.0, 1.8, 2 * np.pi], [1.2, 2.1, -0.1]):
        cases.append((np.array(pose), straight, 0.7, 0.5))
    return cases


def _foot(path: NDArray, place: NDArray) -> Foot:
    foot = Foot(path, window=np.inf)
    foot.move_to(*place)
    return foot


def _ahead(path: NDArray, place: NDArray, lookahead: float) -> NDArray:
    """The point of the path that lies `lookahead` beyond the one nearest to a place."""
    foot = _foot(path, place)
    return np.array([np.interp(foot.way + lookahead, foot.arc, axis) for axis in path.T])


def _steer(pose: NDArray, target: NDArray, speed: float) -> NDArray:
    """The arc to a target, as the start of a path that leads on from there."""
    return pure_pursuit(pose, np.array([target, 2 * target - pose[:2]]), 0.0, speed)


def _turning(factor: Callable[[float, float, float], float]) -> Callable[..., NDArray]:
    """The arc with omega times a factor of d, the look-ahead and the speed."""

    def wrong(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
        d = np.linalg.norm(_ahead(path, pose[:2], lookahead) - pose[:2])
        return pure_pursuit(pose, path, lookahead, speed) * (1, factor(d, lookahead, speed))

    return wrong


def _nearest_vertex(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    near = path[np.linalg.norm(path - pose[:2], axis=1).argmin()]
    return _steer(pose, _ahead(path, near, lookahead), speed)


def _vertex_ahead(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    foot = _foot(path, pose[:2])
    beyond = np.searchsorted(foot.arc, foot.way + lookahead)
    return _steer(pose, path[min(beyond, len(path) - 1)], speed)


def _leaves_the_circle(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    """The library's arc, but to the end of the path where no more than the look-ahead is left."""
    if np.linalg.norm(path[-1] - pose[:2]) < lookahead:
        return _steer(pose, path[-1], speed)
    goal = Goal(path[-1], path[-1], speed, path, time=0.0, waypoint=len(path) - 1)
    return np.array(PurePursuit(lookahead, window=1e9)(pose, np.zeros(2), goal, 0.1))


def _by_angle(
    gain: Callable[[float, float], float], turn: Callable[[float], float] = wrap
) -> Callable[..., NDArray]:
    """Turning in proportion to the angle to the point ahead, by a gain of look-ahead and speed."""

    def wrong(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
        dx, dy = _ahead(path, pose[:2], lookahead) - pose[:2]
        angle = turn(np.arctan2(dy, dx) - pose[2])
        return np.array([speed, gain(lookahead, speed) * angle])

    return wrong


def _own_nearest(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    return _steer(pose, path[np.linalg.norm(path - pose[:2], axis=1).argmin()], speed)


def _vertex_away(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    """The arc to the first way-point from the nearest on that is a look-ahead away, or the last."""
    distance = np.linalg.norm(path - pose[:2], axis=1)
    far = np.flatnonzero(distance[distance.argmin() :] >= lookahead)
    return _steer(pose, path[distance.argmin() + far[0] if len(far) else -1], speed)


def _next_vertex(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    near = np.linalg.norm(path - pose[:2], axis=1).argmin()
    return _steer(pose, path[min(near + 1, len(path) - 1)], speed)


def _how_far_ahead(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    dx, dy = _ahead(path, pose[:2], lookahead) - pose[:2]
    x = np.cos(pose[2]) * dx + np.sin(pose[2]) * dy
    return np.array([speed, speed * 2 * x / (dx**2 + dy**2)])


def _beyond_the_end(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    last = path[-1] - path[-2]
    longer = np.vstack((path, path[-1] + 2 * last / np.linalg.norm(last)))
    near = _foot(path, pose[:2]).place
    return _steer(pose, _ahead(longer, np.array(near), lookahead), speed)


PURSUIT = Exercise(
    number="5.7",
    title="Pure pursuit",
    reference=pure_pursuit,
    oracle="the_arc_ends_on_the_point_ahead",
    cases=_cases,
    mistakes={
        "it turns half as much as it must: the curvature is 2 y_L / d^2, with the factor 2": (
            _turning(lambda d, ahead, v: 0.5)
        ),
        "you look ahead from the start of the path: count from the point nearest the vehicle": (
            lambda pose, path, ahead, v: _steer(pose, _ahead(path, path[0], ahead), v)
        ),
        "you steer to the nearest point itself: go on along the path by the look-ahead": (
            lambda pose, path, ahead, v: pure_pursuit(pose, path, 0.0, v)
        ),
        "you start from the nearest way-point: the nearest point may lie between two": (
            _nearest_vertex
        ),
        "you steer to a way-point: the point ahead may lie between two, interpolate": _vertex_ahead,
        "it turns away from the path: y_L is positive to the left, and so is omega": (
            _turning(lambda d, ahead, v: -1)
        ),
        "y_L is measured in the vehicle's frame: turn the difference by -theta": (
            lambda pose, *given: pure_pursuit(pose * (1, 1, 0), *given)
        ),
        (
            "d is the straight way from the vehicle to the point, not the look-ahead along the path"
        ): _turning(lambda d, ahead, v: (d / ahead) ** 2),
        (
            "you steer to where the path leaves the circle about the vehicle, as the library does: "
            "here the look-ahead is counted along the path"
        ): _leaves_the_circle,
        "the curvature is 2 y_L over d squared: you divide by d once": (
            _turning(lambda d, ahead, v: d)
        ),
        "you steer to the nearest way-point itself: look ahead along the path from there on": (
            _own_nearest
        ),
        "you steer to the way-point after the nearest: the point ahead lies between two of them": (
            _next_vertex
        ),
        "you steer to the first way-point that is far enough: the point ahead lies between two": (
            _vertex_away
        ),
        "that is how far ahead the point lies: y_L is how far to the left": _how_far_ahead,
        "omega is in degrees per second: everything inside the course is in radians": (
            _turning(lambda d, ahead, v: 180 / np.pi)
        ),
        "you turn in proportion to the angle: the arc to the point has curvature 2 y_L / d^2": (
            _by_angle(lambda ahead, v: v)
        ),
        "you turn by the angle as it is, without the speed: the arc has curvature 2 y_L / d^2": (
            _by_angle(lambda ahead, v: 1.0)
        ),
        "you use the look-ahead as a gain: it says which point of the path to take, no more": (
            _by_angle(lambda ahead, v: ahead)
        ),
        "you use the look-ahead as a gain, times v: it says which point to take, no more": (
            _by_angle(lambda ahead, v: ahead * v)
        ),
        "you divide the angle by the look-ahead: the arc to the point has curvature 2 y_L / d^2": (
            _by_angle(lambda ahead, v: v / ahead)
        ),
        "twice the angle over the look-ahead is nearly right: the sine of it, and d for both": (
            _by_angle(lambda ahead, v: 2 * v / ahead)
        ),
        "the angle to the point is not wrapped: after a full turn the vehicle unwinds it again": (
            _by_angle(lambda ahead, v: v, turn=float)
        ),
        "the angle is not wrapped, and the look-ahead is no gain: curvature 2 y_L / d^2": (
            _by_angle(lambda ahead, v: ahead, turn=float)
        ),
        "twice the angle over the look-ahead, and not wrapped: curvature 2 y_L / d^2": (
            _by_angle(lambda ahead, v: 2 * v / ahead, turn=float)
        ),
        "that is 2 sin(angle) over the look-ahead: over d, the straight way to the point": (
            _turning(lambda d, ahead, v: d / ahead)
        ),
        "omega has a sign: for a point on the right it is negative": (
            lambda *given: np.abs(pure_pursuit(*given))
        ),
        "you look back along the path: the point ahead lies further on": (
            lambda pose, path, ahead, v: pure_pursuit(pose, path, -ahead, v)
        ),
        "the path ends at its last point: the point ahead is at most that": _beyond_the_end,
        "that is the curvature: omega is v times as much": _turning(lambda d, ahead, v: 1 / v),
    },
    hints=(
        "Three steps: the point nearest the vehicle, the point so far ahead along the path, the "
        "arc.",
        "y_L = -sin(theta) dx + cos(theta) dy; omega = v 2 y_L / d^2; np.interp over arc lengths "
        "finds the point ahead.",
    ),
    tested_on="40 random paths and poses beside them, and a straight one",
)
