"""Exercise 1.8: the matrix of the tracks repaired."""

from __future__ import annotations

from collections.abc import Callable

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


_SIGNS = np.array([(1, -1), (1, -1), (1, 1)])


def _rows_times(way: float, turn: float) -> Callable[[float], NDArray]:
    return lambda heading: track_matrix(heading) * ((way,), (way,), (turn,))


TRACKS = Exercise(
    number="1.8",
    title="Repair the tracks' matrix",
    reference=track_matrix,
    oracle="belts_that_do_not_slip",
    cases=lambda rng: [
        (heading,) for heading in (*rng.uniform(-np.pi, np.pi, 30), 0.0, np.pi / 2, -np.pi)
    ],
    mistakes={
        "with equal speeds on both sides it stands still: that is the matrix to repair": (
            printed.track_matrix
        ),
        "it divides by r: a larger sprocket must drive faster, so multiply by r": (
            lambda heading: printed.track_matrix(heading) * _SIGNS
        ),
        "both tracks drive the middle forward: no minus in the first two rows": (
            lambda heading: track_matrix(heading) * _SIGNS
        ),
        "the turn has the wrong sign: a faster right track turns the machine to the left": (
            _rows_times(1, -1)
        ),
        "the turn is too fast: divide the difference of the tracks by their whole gauge l": (
            _rows_times(1, 2)
        ),
        "the middle moves at the mean of both tracks: a factor 1/2 is missing": (_rows_times(2, 1)),
        "that takes track speeds in m/s: the sprockets' speeds come in rad/s, so r is missing": (
            lambda heading: track_matrix(heading) / BACKHOE.tracks.sprocket_radius
        ),
    },
    hints=(
        "Put v_r = r Omega_r and v_l = r Omega_l into v and omega, and these into the three rates.",
        "v = r/2 (Omega_r + Omega_l), omega = r/l (Omega_r - Omega_l): rows for x, y and psi.",
    ),
    tested_on="33 headings",
)
