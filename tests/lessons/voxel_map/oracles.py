"""What proves the references of the chapter: each oracle says its way in its docstring."""

from math import exp, isnan, log

import numpy as np
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

# 09a, lasers


def undone_step_by_step(answer, ranges, angle, nod, poses):
    """Back from the point: the pose's inverse, the nod turned back, then a point in a plane."""
    for p, r, a, n, T in zip(answer, ranges, angle, nod, poses, strict=True):
        if np.isnan(r):
            assert np.isnan(p).all()
            continue
        x, y, z, _ = np.linalg.solve(T, [*p, 1.0])
        flat = Rotation.from_euler("y", -n).apply([x, y, z])
        assert_allclose(flat, [r * np.cos(a), r * np.sin(a), 0.0], atol=1e-9)


def by_law(origin, one, other):
    """The angle at `one` of the triangle with `origin` and `other`, from its three sides."""
    a, b = np.linalg.norm(origin - one), np.linalg.norm(other - one)
    c = np.linalg.norm(other - origin)
    return np.arccos(np.clip((a * a + b * b - c * c) / (2 * a * b), -1, 1))


def by_the_law_of_cosines(answer, points, origin):
    """Each pair of neighbours and the laser make a triangle, whose sides give its angle."""
    assert answer.shape == (len(points), points.shape[1] - 1)
    for (line, k), found in np.ndenumerate(answer):
        one, other = points[line, k], points[line, k + 1]
        if np.isnan(one).any() or np.isnan(other).any():
            assert np.isnan(found)
        else:
            assert_allclose(found, by_law(origin, one, other), atol=1e-6)


def pair_by_pair(answer, points, origin):
    """Both ends of each pair with a sharp angle go, one pair after the other; so does NaN."""
    keep = ~np.isnan(points).any(axis=-1)
    for line, k in np.ndindex(len(points), points.shape[1] - 1):
        one, other = points[line, k], points[line, k + 1]
        if np.isfinite(one).all() and np.isfinite(other).all():
            angle = np.degrees(by_law(origin, one, other))
            if angle < 10 or angle > 170:
                keep[line, k] = keep[line, k + 1] = False
    np.testing.assert_array_equal(answer, keep)


# 09b, occupancy


def bayes_with_probabilities_and_their_limits(answer, log_odds, reflected):
    """Bayes' rule on probabilities, voxel by voxel, and the clamps as probabilities."""
    assert np.shape(answer) == log_odds.shape
    for now, told, found in zip(log_odds.flat, reflected.flat, np.ravel(answer), strict=True):
        p = 0.5 if np.isnan(now) else 1 / (1 + exp(-now))
        occupied = 1 / (1 + exp(-1.39 if told else 0.80))
        p = occupied * p / (occupied * p + (1 - occupied) * (1 - p))
        p = min(max(p, 1 / (1 + exp(2.0))), 1 / (1 + exp(-3.48)))
        assert abs(found - log(p / (1 - p))) < 1e-9


def every_voxel_about_a_ray_asked_whether_it_is_cut(answer, origin, end, size, most):
    """Slabs: for each voxel of the box about the ray, when the ray enters and leaves it."""
    length = float(np.linalg.norm(end - origin))
    share = min(1.0, most / length)
    stop = origin + share * (end - origin)
    low, high = (np.floor(f(origin, stop) / size).astype(int) for f in (np.minimum, np.maximum))
    axes = [np.arange(a, b + 1) for a, b in zip(low, high, strict=True)]
    cells = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)
    times = (np.stack([cells, cells + 1]) * size - origin) / (end - origin)
    enter = np.maximum(times.min(axis=0).max(axis=1), 0.0)
    leave = np.minimum(times.max(axis=0).min(axis=1), share)
    order = np.argsort(enter[leave > enter + 1e-12])
    way = cells[leave > enter + 1e-12][order]
    told = np.full(len(way), -0.80)
    told[-1] = 1.39
    if share < 1:
        way, told = way[:-1], told[:-1]
    assert np.shape(answer) == (len(way), 4)
    np.testing.assert_array_equal(answer[:, :3], way)
    np.testing.assert_allclose(answer[:, 3], told, rtol=1e-9)


def counted_look_by_look(answer, log_odds, occupied):
    """Looks added one after the other until the voxel changes sides."""
    odds, looks = log_odds, 0
    while isnan(odds) or (odds >= 0) != occupied:
        odds = (0.0 if isnan(odds) else odds) + (1.39 if occupied else -0.80)
        looks += 1
    assert answer == looks


# 09c, terrain


def weighted_by_information_or_begun_anew(answer, h, P, z, R, gate):
    """The mean of both weighed by 1 / variance; the past counts only within the gate's interval."""
    half = gate * np.hypot(P**0.5, R**0.5)
    past = not np.isnan(h) and h - half <= z <= h + half
    heights, variances = ([h, z], [P, R]) if past else ([z], [R])
    weights = 1 / np.array(variances)
    assert_allclose(answer, (np.average(heights, weights=weights), 1 / weights.sum()), rtol=1e-9)


def a_weighted_sum_by_its_whole_covariance(
    answer, before, after, var_before, var_after, cell, lift
):
    """Mean and variance of w . h for all heights in a row, whose covariance is written out."""
    n = before.size
    weights = np.repeat([cell**2, -(cell**2)], n)
    C = np.diag(np.r_[var_before.ravel(), var_after.ravel()])
    C[:n, :n] += lift**2
    C[n:, n:] += lift**2
    value = weights @ np.r_[before.ravel(), after.ravel()]
    assert_allclose(answer, (value, (weights @ C @ weights) ** 0.5), rtol=1e-9)


def all_pairs_of_voxels(answer, occupied, cell):
    """Each voxel's distance to each occupied one, as complex numbers, and the least of them."""
    i, j = np.indices(occupied.shape)
    places = i + 1j * j
    assert_allclose(
        answer, cell * abs(places[..., None] - places[occupied]).min(axis=-1), atol=1e-9
    )


EQUAL = {
    "9.1": {
        "ranges is never negative": "a range",
        "poses[2] is never negative": "the mount turns about the vertical",
    },
    "9.5": {
        "size is never negative": "a voxel's edge",
        "most is never negative": "a range",
    },
    "9.7": {
        "value 1 of the result is never negative": "a variance",
        "P is never negative": "a variance",
        "R is never negative": "a variance",
        "gate: zero for negative": "a number of standard deviations",
    },
    "9.8": {
        "var_before is never negative": "variances",
        "var_after is never negative": "variances",
        "cell: zero for negative": "a cell's edge",
        "lift: zero for negative": "a height's standard deviation",
    },
}
"""Mutants that are the reference in disguise, with the reason."""
