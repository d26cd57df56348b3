"""Exercise 5.7: pure pursuit of a polyline."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.lessons.exercise import Exercise


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
    return cases


def _foot(pose: NDArray, path: NDArray) -> float:
    """Way along the path to the point nearest the pose [m]."""
    start, way = path[:-1], np.diff(path, axis=0)
    share = ((pose[:2] - start) * way).sum(axis=1) / (way**2).sum(axis=1)
    share = np.clip(share, 0.0, 1.0)
    near = np.linalg.norm(pose[:2] - start - share[:, None] * way, axis=1).argmin()
    return _arc(path)[near] + share[near] * np.linalg.norm(way[near])


def _arc(path: NDArray) -> NDArray:
    return np.append(0.0, np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1)))


def _at(path: NDArray, way: float) -> NDArray:
    return np.array([np.interp(way, _arc(path), axis) for axis in path.T])


def _steer(pose: NDArray, target: NDArray, speed: float) -> NDArray:
    dx, dy = target - pose[:2]
    aside = -np.sin(pose[2]) * dx + np.cos(pose[2]) * dy
    return np.array([speed, 2 * speed * aside / (dx**2 + dy**2)])


def _nearest_vertex(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    near = np.linalg.norm(path - pose[:2], axis=1).argmin()
    return _steer(pose, _at(path, _arc(path)[near] + lookahead), speed)


def _vertex_ahead(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    arc = _arc(path)
    beyond = min(np.searchsorted(arc, _foot(pose, path) + lookahead), len(arc) - 1)
    return _steer(pose, path[beyond], speed)


def _target(pose: NDArray, path: NDArray, lookahead: float) -> NDArray:
    return _at(path, _foot(pose, path) + lookahead)


def _leaves_the_circle(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    """Steer to where the path, from the nearest point on, leaves the circle of that radius."""
    arc = _arc(path)
    start = _foot(pose, path)
    here = np.searchsorted(arc, start, "right") - 1
    for a, b in zip(path[here:-1], path[here + 1 :], strict=True):
        if np.linalg.norm(b - pose[:2]) > lookahead:
            way, aside = (b - a) / np.linalg.norm(b - a), a - pose[:2]
            along = -aside @ way
            along += np.sqrt(along**2 - aside @ aside + lookahead**2)
            return _steer(pose, a + along * way, speed)
    return _steer(pose, path[-1], speed)


def _lookahead_for_distance(
    pose: NDArray, path: NDArray, lookahead: float, speed: float
) -> NDArray:
    target = _target(pose, path, lookahead)
    distance = np.linalg.norm(target - pose[:2])
    return _steer(pose, target, speed) * (1.0, distance**2 / lookahead**2)


def _by_angle(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    dx, dy = _target(pose, path, lookahead) - pose[:2]
    angle = np.arctan2(dy, dx) - pose[2]
    return np.array([speed, speed * ((angle + np.pi) % (2 * np.pi) - np.pi)])


def _fixed_frame(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    way = _target(pose, path, lookahead) - pose[:2]
    return np.array([speed, 2 * speed * way[1] / (way @ way)])


def _distance_once(pose: NDArray, path: NDArray, lookahead: float, speed: float) -> NDArray:
    distance = np.linalg.norm(_target(pose, path, lookahead) - pose[:2])
    return pure_pursuit(pose, path, lookahead, speed) * (1.0, distance)


PURSUIT = Exercise(
    number="5.7",
    title="Pure pursuit",
    reference=pure_pursuit,
    cases=_cases,
    mistakes={
        "it turns half as much as it must: the curvature is 2 y_L / d^2, with the factor 2": (
            lambda pose, path, ahead, v: pure_pursuit(pose, path, ahead, v) * (1.0, 0.5)
        ),
        "you look ahead from the start of the path: count from the point nearest the vehicle": (
            lambda pose, path, ahead, v: _steer(pose, _at(path, ahead), v)
        ),
        "you steer to the nearest point itself: go on along the path by the look-ahead": (
            lambda pose, path, ahead, v: pure_pursuit(pose, path, 0.0, v)
        ),
        "you start from the nearest way-point: the nearest point may lie between two": (
            _nearest_vertex
        ),
        "you steer to a way-point: the point ahead may lie between two, interpolate": (
            _vertex_ahead
        ),
        "it turns away from the path: y_L is positive to the left, and so is omega": (
            lambda pose, path, ahead, v: pure_pursuit(pose, path, ahead, v) * (1.0, -1.0)
        ),
        "y_L is measured in the vehicle's frame: turn the difference by -theta": _fixed_frame,
        (
            "d is the straight way from the vehicle to the point, not the look-ahead along the path"
        ): _lookahead_for_distance,
        (
            "you steer to where the path leaves the circle about the vehicle, as the library does: "
            "here the look-ahead is counted along the path"
        ): _leaves_the_circle,
        "the curvature is 2 y_L over d squared: you divide by d once": _distance_once,
        "you turn in proportion to the angle: the arc to the point has curvature 2 y_L / d^2": (
            _by_angle
        ),
        "that is the curvature: omega is v times as much": (
            lambda pose, path, ahead, v: pure_pursuit(pose, path, ahead, v) / (1.0, v)
        ),
    },
    hints=(
        "Three steps: the point nearest the vehicle, the point so far ahead along the path, the "
        "arc.",
        "y_L = -sin(theta) dx + cos(theta) dy; omega = v 2 y_L / d^2; np.interp over arc lengths "
        "finds the point ahead.",
    ),
    tested_on="40 random paths and poses beside them",
)
