"""What proves the references of the chapter: each oracle says its way in its docstring."""

import numpy as np
from numpy.testing import assert_allclose
from scipy.optimize import brentq, root

# 08a, camera


def bent(x, y, k1, k2, p1, p2, k3):
    """Brown's lens in complex numbers, z = x + i y: radial along z; tangential by
    (r^2 + 2 x^2) + 2 i x y = 2 r^2 + z^2 and 2 x y + i (r^2 + 2 y^2) = i (2 r^2 - z^2)."""
    z = complex(x, y)
    r2 = (z * z.conjugate()).real
    new = z * np.polyval([k3, k2, k1, 1.0], r2)
    new += p2 * (2 * r2 + z * z) + p1 * 1j * (2 * r2 - z * z)
    return np.array([new.real, new.imag])


def the_lens_term_by_term(answer, point, K, distortion):
    """Brown's lens with complex numbers, and the pixel as the ray through K."""
    wanted = K @ np.append(bent(*(point[:2] / point[2]), *distortion), 1.0)
    assert_allclose(answer, wanted[:2], rtol=1e-12)


def a_root_found_by_scipy(answer, pixel, K, distortion):
    """SciPy's hybrid method finds where the lens, in complex numbers, gives the pixel."""
    goal = np.linalg.solve(K, np.append(pixel, 1.0))[:2]
    found = root(lambda plane: bent(*plane, *distortion) - goal, goal, tol=1e-12)
    assert found.success
    assert_allclose(answer, found.x, atol=1e-9)


def the_plane_through_both_cameras(answer, left, right, K_left, K_right, R, t):
    """Two points of the left pixel's ray, as the right camera sees them, span the line."""
    ray = np.linalg.solve(K_left, np.append(left, 1.0))
    near, far = (K_right @ (R @ (depth * ray) + t) for depth in (5.0, 50.0))
    near, far = near[:2] / near[2], far[:2] / far[2]
    (a, b), (c, d) = far - near, right - near
    assert_allclose(answer, abs(a * d - b * c) / np.hypot(a, b), rtol=1e-7, atol=1e-9)


def seen_again_by_both_cameras(answer, u, v, d, f, cx, cy, baseline):
    """Both cameras see the point where it was seen, and none has it behind itself."""
    K = np.array([[f, 0, cx], [0, f, cy], [0, 0, 1]])
    left, right = K @ answer, K @ (answer - [baseline, 0, 0])
    assert left[2] > 0
    assert_allclose(left[:2] / left[2], [u, v], rtol=1e-9, atol=1e-9)
    assert_allclose(right[:2] / right[2], [u - d, v], rtol=1e-9, atol=1e-7)


# 08b, matching


def the_last_disparity_and_the_slope_of_depth(answer, f, B, disparities, sigma, most):
    """Similar triangles for the nearest; the farthest by a search, its slope by a complex step."""
    near, far = answer
    assert_allclose(near * list(range(disparities))[-1] / f, B, rtol=1e-9)

    def deviation(z):
        return sigma * abs((f * B / (f * B / z + 1e-30j)).imag) / 1e-30

    assert_allclose(far, brentq(lambda z: deviation(z) - most, 1e-3, 1e5, rtol=1e-12), rtol=1e-6)


def each_right_pixel_is_asked_by_itself(answer, costs):
    """One left pixel after another, and for each its right pixel, by loops."""
    disparities, rows, columns = costs.shape
    assert answer.shape == (rows, columns)
    for i, j in np.ndindex(rows, columns):
        finite = {d: costs[d, i, j] for d in range(disparities) if costs[d, i, j] < np.inf}
        wanted = np.nan
        if finite:
            d = min(finite, key=finite.get)
            c = j - d
            back = {e: costs[e, i, c + e] for e in range(disparities) if c + e < columns}
            if abs(min(back, key=back.get) - d) < 1.5:
                wanted = d
        assert_allclose(answer[i, j], wanted)


def two_lines_of_sight_by_least_squares(answer, disparity, f, B, cx, cy):
    """Each point solves the four equations of its two pixels, u (0, 0, 1) p = f p_x + ..."""
    good = [(i, j) for i, j in np.ndindex(disparity.shape) if 0 < disparity[i, j] < np.inf]
    assert np.shape(answer) == (len(good), 3)
    for point, (i, j) in zip(answer, good, strict=True):
        c = j - disparity[i, j]
        A = [[f, 0, cx - j], [0, f, cy - i], [f, 0, cx - c], [0, f, cy - i]]
        found = np.linalg.lstsq(np.array(A), np.array([0, 0, f * B, 0]), rcond=None)[0]
        assert_allclose(point, found, rtol=1e-7, atol=1e-9)


def each_window_is_its_partner_but_for_the_light(answer, left, right):
    """The windows of each answered pixel and its partner differ by a constant, and none is even.

    The prefilter sees texture up to 4 pixels outside of a window of 15.
    """
    assert np.isfinite(answer)[8:-8, 142:-8].mean() > 0.5
    found = answer[np.isfinite(answer)]
    assert abs(np.median(found - np.rint(found))) < 0.05
    for i, j in np.argwhere(np.isfinite(answer)):
        d = round(float(answer[i, j]))
        assert 7 <= j - d
        out = min(11, j - d, left.shape[1] - 1 - j)
        mine, partner = (
            eye[max(i - 11, 0) : i + 12, column - out : column + out + 1].astype(float)
            for eye, column in ((left, j), (right, j - d))
        )
        assert mine.std() > 0.1 and (mine - partner).std() < 1e-9


EQUAL = {
    "8.8": {
        "the result: whole numbers": "a matcher is asked to be within a pixel",
        "the result: rolled along the first axis": "the next row is mostly within a pixel",
    },
    "8.1": {"the result is never negative": "a pixel of the picture, counted from its corner"},
    "8.2": {"pixel[0] is never negative": "a pixel of the picture, counted from its corner"},
    "8.3": {"left is never negative": "a pixel of the picture, counted from its corner"},
    "8.4": {
        "the result at [2] is never negative": "what both eyes see is in front of them",
        **dict.fromkeys(
            [f"{name} is never negative" for name in ("u", "v", "d", "f", "cx", "cy", "baseline")],
            "pixels of the picture, a disparity, a focal length and a distance of two eyes",
        ),
    },
    "8.6": {
        "the result is never negative": "depths",
        "value 0 of the result is never negative": "a depth",
        "disparities is never negative": "a count",
    },
    "8.7": {
        "the result at [2] is never negative": "what both eyes see is in front of them",
        **dict.fromkeys(
            [f"{name} is never negative" for name in ("f", "B", "cx", "cy")],
            "a focal length, a distance of two eyes, and the middle of the picture",
        ),
    },
}
"""Mutants that are the reference in disguise, with the reason."""
