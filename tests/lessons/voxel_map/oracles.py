"""What proves the references of the chapter: each oracle says its way in its docstring."""

import numpy as np
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

# lesson 09a, lasers


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
