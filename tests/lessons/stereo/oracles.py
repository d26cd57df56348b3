"""What proves the references of the chapter: each oracle says its way in its docstring."""

import numpy as np
from numpy.testing import assert_allclose
from scipy.optimize import root

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
