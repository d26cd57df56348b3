"""Exercise 1.8: the printed matrix of the tracks repaired."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.lessons.kinematics import printed
from backhoe.machine import BACKHOE


def track_matrix(heading: float) -> NDArray:
    """Matrix from the sprockets' speeds (right, left) [rad/s] to (dx, dy, dpsi), shape (3, 2)."""
    r, gauge = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge
    x, y = r / 2 * np.cos(heading), r / 2 * np.sin(heading)
    return np.array([[x, x], [y, y], [r / gauge, -r / gauge]])


def _scaled(rows: float | tuple[float, float, float], heading: float) -> NDArray:
    return track_matrix(heading) * np.reshape(np.broadcast_to(rows, 3), (3, 1))


def _signs_only(heading: float) -> NDArray:
    return printed.track_matrix(heading) * ((1, -1), (1, -1), (1, 1))


def _radii_only(heading: float) -> NDArray:
    return track_matrix(heading) * ((1, -1), (1, -1), (1, 1))


_RADIUS = BACKHOE.tracks.sprocket_radius

TRACKS = Exercise(
    number="1.8",
    title="Repair (2.10)",
    reference=track_matrix,
    cases=lambda rng: [(heading,) for heading in rng.uniform(-np.pi, np.pi, 30)],
    mistakes={
        "that is (2.10) as printed: with equal speeds on both sides it stands still": (
            printed.track_matrix
        ),
        "it divides by r: a larger sprocket must drive faster, so multiply by r": _signs_only,
        "both tracks drive the middle forward: no minus in the first two rows": _radii_only,
        "the turn has the wrong sign: a faster right track turns the machine to the left": (
            lambda heading: _scaled((1, 1, -1), heading)
        ),
        "the turn is too fast: divide the difference of the tracks by their whole gauge l": (
            lambda heading: _scaled((1, 1, 2), heading)
        ),
        "the middle moves at the mean of both tracks: a factor 1/2 is missing": (
            lambda heading: _scaled((2, 2, 1), heading)
        ),
        "that takes track speeds in m/s: the sprockets' speeds come in rad/s, so r is missing": (
            lambda heading: _scaled(1 / _RADIUS, heading)
        ),
    },
    hints=(
        "Put v_r = r Omega_r and v_l = r Omega_l into (2.9), and what comes out into (2.8).",
        "v = r/2 (Omega_r + Omega_l), omega = r/l (Omega_r - Omega_l): rows for x, y and psi.",
    ),
    tested_on="30 random headings",
)
