"""Independent answers to the exercises of lessons 10a, 10b and 10c, movement primitives."""

from __future__ import annotations

from math import comb

import numpy as np
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from backhoe.arm.kinematics import forward_kinematics

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


def a_very_stiff_spring_is_followed(answer, x, s, new_goal):
    """(6.8) gives f of a spring without mass; (6.4) with the new goal says where it lies."""
    g, x0 = x[-1], x[0]
    f = -(g - x) + (g - x0) * s[:, None]
    assert_allclose(answer, new_goal - (new_goal - x0) * s[:, None] + f, atol=1e-9)
    assert_allclose(answer[0], x0, atol=1e-9)


def ends_hold_and_the_shift_is_the_smoothest(answer, x, t, new_start, new_goal):
    """What is added is the one quintic of time that rests at both ends: a linear system."""
    A = []
    for time in (t[0], t[-1]):
        u = time - t[0]
        A += [
            [u**k for k in range(6)],
            [k * u ** (k - 1) if k else 0.0 for k in range(6)],
            [k * (k - 1) * u ** (k - 2) if k > 1 else 0.0 for k in range(6)],
        ]
    ends, still = [new_start - x[0], new_goal - x[-1]], np.zeros((2, x.shape[1]))
    b = np.vstack([ends[0], still, ends[1], still])
    added = np.vander(t - t[0], 6, increasing=True) @ np.linalg.solve(np.array(A), b)
    assert_allclose(answer, x + added, rtol=1e-7, atol=1e-7)


def digs_as_shown_and_ends_over_the_truck(answer, dig, load, shift):
    """The dig as shown; then the load as shown and a shift made of Bernstein's polynomials."""
    t, x = answer
    assert x.shape == (len(t), 4)
    assert_allclose(np.diff(t), t[1] - t[0], rtol=1e-9)
    over = dig[0][-1]
    assert_allclose(t[[0, -1]], [0.0, over + load[0][-1]], atol=0.02)
    wanted = np.column_stack([np.interp(t, dig[0], column) for column in dig[1].T])
    later = t > over
    u = np.minimum((t[later] - over) / load[0][-1], 1.0)
    moved = np.column_stack([np.interp(t[later] - over, load[0], c) for c in load[1].T])
    m = sum(comb(5, k) * u**k * (1 - u) ** (5 - k) for k in (3, 4, 5))
    wanted[later] = moved + m[:, None] * [*shift, 0.0, 0.0]
    assert_allclose(x, wanted, atol=3e-3)
    assert_allclose(x[-1], load[1][-1] + [*shift, 0.0, 0.0], atol=1e-9)
    assert np.abs(np.diff(x, 2, axis=0)).max() < 2e-3


# improvement


def its_work_is_that_of_the_joints(answer, q, given, needed):
    """Moved a little in any way, the push does the work that the joints' torques lack."""
    for dq in np.eye(4):
        ends = [forward_kinematics(q + way * dq, "tip")[:3, 3] for way in (-1e-6, 1e-6)]
        moved = (ends[1] - ends[0]) / 2e-6
        work = answer[:3] @ moved + answer[3] * dq[1:].sum()
        assert_allclose(work, dq @ (needed - given), rtol=1e-5, atol=0.05)


def logarithms_of_the_shares(answer, costs, hardness):
    """Shares of one; the logarithm of two shares' ratio is their costs' difference over the range,
    times -h; a failed try has none."""
    assert_allclose(np.sum(answer), 1.0, rtol=1e-9)
    done = np.isfinite(costs)
    assert not answer[~done].any()
    best = costs[done].argmin()
    logs = np.log(answer[done] / answer[done][best])
    away = costs[done] - costs[done][best]
    assert_allclose(logs, -hardness * away / away.max(), rtol=1e-9, atol=1e-9)


def a_mean_with_weights_from_logarithms(answer, tries, costs):
    """The weighted mean of NumPy, its weights from sums of logarithms; what failed is left out."""
    done = np.isfinite(costs)
    tries, costs = tries[done], costs[done]
    order = np.argsort(costs)
    logs = -10.0 * (costs - costs.min()) / (costs.max() - costs.min())
    shares = [np.exp(one - np.logaddexp.reduce(logs)) for one in logs]
    assert_allclose(answer, np.average(tries[order], axis=0, weights=np.take(shares, order)))


EQUAL = {
    "10.1": {"K is never negative": "a spring's stiffness"},
    "10.2": {
        "s is never negative": "the phase falls from 1 towards 0",
        "tau is never negative": "a duration",
        "K is never negative": "a spring's stiffness",
        "D is never negative": "a damper's",
    },
    "10.3": {
        "s is never negative": "the phase falls from 1 towards 0",
        "centres is never negative": "places in the phase",
        "widths is never negative": "widths of bells",
    },
    "10.5": {"s is never negative": "the phase falls from 1 towards 0"},
}
"""Mutants that are the reference in disguise, with the reason."""
