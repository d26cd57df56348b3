"""Independent answers to the exercises of lessons 10a, 10b and 10c, movement primitives."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

# primitives


def roots_meet_and_the_clock_runs_down(answer, K, tau, duration, end):
    """NumPy's roots of the spring are equal; SciPy integrates the phase down to its end."""
    D, alpha = answer
    for sure, damping in ((True, D * (1 + 1e-4)), (False, D * (1 - 1e-4))):
        roots = np.roots([tau**2, damping * tau, K])
        assert bool(np.all(np.isreal(roots))) == sure and np.all(roots.real < 0)
    fell = solve_ivp(lambda t, s: -alpha * s / tau, (0, duration), [1.0], rtol=1e-10, atol=1e-13)
    assert_allclose(fell.y[0, -1], end, rtol=1e-6)


def put_back_into_the_spring(answer, x, dx, ddx, s, tau, K, D):
    """The spring of (6.4), pushed by f, accelerates as demonstrated."""
    g, x0 = x[-1], x[0]
    assert answer.shape == x.shape
    pushed = K * (g - x) - D * (tau * dx) - K * (g - x0) * s + K * answer  # tau dv/dt
    assert_allclose(pushed / tau**2, ddx, atol=1e-8 * (1 + K / tau**2))


def least_squares_of_each_kernel_alone(answer, s, f, centres, widths):
    """NumPy's least squares, samples multiplied by the root of the kernel: (B.6) and (B.7)."""
    for w, c, h in zip(answer, centres, widths, strict=True):
        psi = np.exp(-h * (s - c) ** 2 / 2)
        assert_allclose(w, np.linalg.lstsq((psi * s)[:, None], psi * f, rcond=None)[0][0])


def parabolas_by_numpy(answer, times, x, half):
    """A Vandermonde matrix for the samples near each time, solved by singular values."""
    for found, t in zip(answer, times, strict=True):
        near = np.abs(times - t) < half
        A = np.vander(times[near] - t, 3)
        assert_allclose(found, 2 * (np.linalg.pinv(A) @ x[near])[0], rtol=1e-6, atol=1e-7)


# new_goals

# improvement
