"""Exercises of lesson 08a: a point's pixel, a pixel's ray, a pair's lines, and points from Q."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.perception.camera import Pinhole, epipolar_lines, fundamental_matrix, rotation

__all__ = ["EXERCISES"]

_SIZE = (640, 480)


def project(point: NDArray, K: NDArray, distortion: NDArray) -> NDArray:
    """Pixel of a point in the camera's frame through its lens, shape (2,) [pixels]."""
    return Pinhole(K, _SIZE, distortion).project(point)


def ray(pixel: NDArray, K: NDArray, distortion: NDArray) -> NDArray:
    """Point of the plane z = 1 that is seen at a pixel, shape (2,) [1]."""
    return Pinhole(K, _SIZE, distortion).undistort(pixel)


def line_distance(
    left: NDArray, right: NDArray, K_left: NDArray, K_right: NDArray, R: NDArray, t: NDArray
) -> float:
    """Distance of a right pixel from the line of a left one, without distortion [pixels]."""
    F = fundamental_matrix(Pinhole(K_left, _SIZE), Pinhole(K_right, _SIZE), R, t)
    return float(abs(epipolar_lines(F, left) @ np.append(right, 1.0)))


def point_of(
    u: float, v: float, d: float, f: float, cx: float, cy: float, baseline: float
) -> NDArray:
    """Point in the left camera's rectified frame, shape (3,) [m], from column, row, disparity."""
    Z = f * baseline / d
    return np.array([(u - cx) * Z / f, (v - cy) * Z / f, Z])


def _intrinsic(rng: np.random.Generator) -> NDArray:
    fx, fy, cx, cy = rng.uniform([480, 490, 280, 200], [620, 630, 360, 280])
    return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])


def _lens(rng: np.random.Generator) -> NDArray:
    return rng.uniform([-0.3, -0.1, -4e-3, -4e-3, -0.02], [0.1, 0.1, 4e-3, 4e-3, 0.02])


def _point(rng: np.random.Generator) -> NDArray:
    return rng.uniform(2.0, 9.0) * np.r_[rng.uniform([-0.5, -0.4], [0.5, 0.4]), 1.0]


def _points(rng: np.random.Generator) -> list[tuple]:
    return [(_point(rng), _intrinsic(rng), _lens(rng)) for _ in range(40)]


def _pixels(rng: np.random.Generator) -> list[tuple]:
    return [(project(*case), *case[1:]) for case in _points(rng)]


def _pairs(rng: np.random.Generator) -> list[tuple]:
    """Two cameras and a match that misses its line by some pixels."""
    cases = []
    for _ in range(40):
        R, t = (
            rotation(rng.uniform(-0.1, 0.1, 3)),
            rng.uniform([-0.6, -0.1, -0.1], [-0.3, 0.1, 0.1]),
        )
        p, one, other = _point(rng), _intrinsic(rng), _intrinsic(rng)
        right = project(R @ p + t, other, np.zeros(5)) + rng.choice([-1, 1]) * rng.uniform(2, 9, 2)
        cases.append((project(p, one, np.zeros(5)), right, one, other, R, t))
    return cases


def _rectified(rng: np.random.Generator) -> list[tuple]:
    low, high = [0, 0, 2, 450, 280, 200, 0.2], [640, 480, 120, 650, 360, 280, 0.8]
    return [tuple(rng.uniform(low, high).tolist()) for _ in range(40)]


def _lensed(change: Callable) -> Callable:
    """The projection with a changed lens."""
    return lambda point, K, distortion: project(point, K, change(distortion))


def _by_radius(point: NDArray, K: NDArray, distortion: NDArray) -> NDArray:
    x, y = point[:2] / point[2]
    r = np.hypot(x, y)
    k1, k2, p1, p2, k3 = distortion
    radial = 1 + k1 * r + k2 * r**2 + k3 * r**3
    x_d = x * radial + 2 * p1 * x * y + p2 * (r**2 + 2 * x**2)
    y_d = y * radial + p1 * (r**2 + 2 * y**2) + 2 * p2 * x * y
    return K[:2, :2] @ [x_d, y_d] + K[:2, 2]


def _swapped(K: NDArray) -> NDArray:
    """K with its focal lengths swapped."""
    return np.array([[K[1, 1], 0, K[0, 2]], [0, K[0, 0], K[1, 2]], [0, 0, 1]])


PROJECT = Exercise(
    number="8.1",
    title="From a point to its pixel",
    reference=project,
    cases=_points,
    oracle="the_lens_term_by_term",
    mistakes={
        "the lens is missing: that is the pinhole alone": _lensed(np.zeros_like),
        "only k1, k2, k3: the tangential terms with p1 and p2 are missing": (
            _lensed(lambda D: D * [1, 1, 0, 0, 1])
        ),
        "p1 and p2 are swapped: p1 goes with r^2 + 2 y^2 in y, p2 with r^2 + 2 x^2 in x": (
            _lensed(lambda D: D[[0, 1, 3, 2, 4]])
        ),
        "k3 is missing: it stands last, after p1 and p2": _lensed(lambda D: D * [1, 1, 1, 1, 0]),
        "the order of the coefficients is k1, k2, p1, p2, k3: k3 is the last one": (
            _lensed(lambda D: D[[0, 1, 3, 4, 2]])
        ),
        "radial means even powers: k1 r^2 + k2 r^4 + k3 r^6, not r, r^2, r^3": _by_radius,
        "divide by Z first: the lens bends x = X / Z and y = Y / Z": (
            lambda point, K, D: project(np.append(point[:2], 1.0), K, D)
        ),
        "the principal point is missing: add cx and cy": (
            lambda point, K, D: project(point, K, D) - K[:2, 2]
        ),
        "fx and fy are swapped: fx is for columns": (
            lambda point, K, D: project(point, _swapped(K), D)
        ),
        "column first, then row: x belongs to the column": (
            lambda point, K, D: project(point, K, D)[::-1]
        ),
    },
    hints=(
        "Three steps: divide by Z, bend x and y by the lens, scale by fx, fy and add cx, cy.",
        "Compute r^2 = x^2 + y^2 once from the unbent x and y, and use it in all terms.",
    ),
    tested_on="40 random points, cameras and lenses",
)


def _iterated(
    pixel: NDArray, K: NDArray, distortion: NDArray, rounds: int = 40, sign: float = 1.0
) -> NDArray:
    """Fixed point of x = wanted - (lens(x) - x), or with the lens's bend the other way."""
    lens = Pinhole(np.eye(3), _SIZE, distortion)
    wanted = (pixel - K[:2, 2]) / K[[0, 1], [0, 1]]
    plane = wanted
    for _ in range(rounds):
        plane = wanted - sign * (lens.distort(plane) - plane)
    return plane


RAY = Exercise(
    number="8.2",
    title="From a pixel back to its ray",
    reference=ray,
    cases=_pixels,
    oracle="a_root_found_by_scipy",
    mistakes={
        "the lens is not removed: that is K^-1 alone": partial(_iterated, rounds=0),
        "one round is not enough: go on until the point does not move any more": (
            partial(_iterated, rounds=1)
        ),
        "five rounds are not enough for the edge of a picture: wait until it stands still": (
            partial(_iterated, rounds=5)
        ),
        "the lens is put on once more: subtract what it adds": (
            partial(_iterated, rounds=1, sign=-1.0)
        ),
        "that is a pixel again: return the point of the plane z = 1": (
            lambda pixel, K, D: K[:2, :2] @ ray(pixel, K, D) + K[:2, 2]
        ),
        "the principal point is not subtracted: (u - cx) / fx": (
            lambda pixel, K, D: ray(pixel + K[:2, 2], K, D)
        ),
        "the tangential part stays in: remove p1 and p2 as well": (
            lambda pixel, K, D: ray(pixel, K, D * [1, 1, 0, 0, 1])
        ),
    },
    hints=(
        "Start at x = (u - cx) / fx, y = (v - cy) / fy, as if there were no lens: call it wanted.",
        "Repeat x = wanted - (distort(x) - x) some 40 times: at rest, distort(x) is wanted.",
    ),
    tested_on="40 random pixels, cameras and lenses; to eight digits",
    rtol=1e-8,
)


def _distance(
    left: NDArray,
    right: NDArray,
    K_left: NDArray,
    K_right: NDArray,
    R: NDArray,
    t: NDArray,
    *,
    way: Callable = lambda F: F,
    norm: Callable = lambda line: np.hypot(line[0], line[1]),
    sign: Callable = abs,
) -> float:
    """The distance with F changed, another norm of the line or a sign."""
    x, y, z = t
    E = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) @ R
    line = way(np.linalg.inv(K_right).T @ E @ np.linalg.inv(K_left)) @ np.append(left, 1.0)
    return float(sign(line @ np.append(right, 1.0) / norm(line)))


LINE = Exercise(
    number="8.3",
    title="How far from its line?",
    reference=line_distance,
    cases=_pairs,
    oracle="the_plane_through_both_cameras",
    mistakes={
        "divide by sqrt(a^2 + b^2): a u + b v + c alone is no distance": (
            partial(_distance, norm=lambda line: 1.0)
        ),
        "divide by sqrt(a^2 + b^2), without c: a line's distance counts in the picture": (
            partial(_distance, norm=np.linalg.norm)
        ),
        "F is transposed: its transpose takes right pixels to lines of the left picture": (
            partial(_distance, way=lambda F: F.T)
        ),
        "a distance has no sign: take the absolute value": partial(_distance, sign=float),
        "left and right camera are swapped: K_right belongs to the right pixel": (
            lambda left, right, K_left, K_right, R, t: line_distance(
                left, right, K_right, K_left, R, t
            )
        ),
        "E is [t]x R, with R on the right: p_right = R p_left + t": (
            lambda left, right, K_left, K_right, R, t: line_distance(
                left, right, K_left, K_right, R, R @ t
            )
        ),
        "R turns left into right: you have used its transpose": (
            lambda left, right, K_left, K_right, R, t: line_distance(
                left, right, K_left, K_right, R.T, t
            )
        ),
        "that is the distance of the left pixel from the right one's line": (
            lambda left, right, K_left, K_right, R, t: line_distance(
                right, left, K_right, K_left, R.T, -R.T @ t
            )
        ),
    },
    hints=(
        "E = [t]x R, F = K_right^-T E K_left^-1; the line is F times (u, v, 1) of the left pixel.",
        "With the line (a, b, c): |a u + b v + c| / sqrt(a^2 + b^2) for the right pixel (u, v).",
    ),
    tested_on="40 random pairs and matches that miss by some pixels",
)


def _changed(change: Callable) -> Callable:
    """What change(right point, u, v, d, f, cx, cy, baseline) makes of the right point."""
    return lambda *given: change(point_of(*given), *given)


POINT = Exercise(
    number="8.4",
    title="Repair the reprojection",
    reference=point_of,
    cases=_rectified,
    oracle="seen_again_by_both_cameras",
    mistakes={
        "that is the code as it was: three faults are in it": (
            lambda u, v, d, f, cx, cy, b: np.array([u, v, f]) * (-b / d)
        ),
        "the point is behind the camera: d = u_left - u_right is more than 0, and so is Z": (
            _changed(lambda p, *given: -p)
        ),
        "the principal point is not subtracted: a pixel at (cx, cy) lies straight ahead": (
            lambda u, v, d, f, cx, cy, b: point_of(u, v, d, f, 0.0, 0.0, b)
        ),
        "cx and cy are swapped: cx is a column": (
            lambda u, v, d, f, cx, cy, b: point_of(u, v, d, f, cy, cx, b)
        ),
        "Z is right, X and Y are not: (u - cx) Z / f": (
            lambda u, v, d, f, cx, cy, b: np.array([u - cx, v - cy, f * b / d])
        ),
        "depth does not grow with the disparity: Z = f B / d": (
            lambda u, v, d, f, cx, cy, b: np.array([u - cx, v - cy, f]) * d * b / f
        ),
        "y points down in a camera's frame: Y has the sign of v - cy": (
            _changed(lambda p, *given: p * [1, -1, 1])
        ),
        "the baseline is missing: without it a picture has no metres": (
            _changed(lambda p, *given: p / given[-1])
        ),
        "the point is in the right camera's frame: its column is u - d": (
            lambda u, v, d, f, cx, cy, b: point_of(u - d, v, d, f, cx, cy, b)
        ),
    },
    hints=(
        "Take a pixel at (cx, cy): where must its point lie? Take d twice as large: what of Z?",
        "Z = f B / d, X = (u - cx) Z / f, Y = (v - cy) Z / f: it is Q times (u, v, d, 1), divided.",
    ),
    tested_on="40 random pixels, disparities and rectified pairs",
)

EXERCISES = (PROJECT, RAY, LINE, POINT)
