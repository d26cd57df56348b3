"""The slides' experiment: the same long path with and without the homogeneous solution.

The small robot draws a level figure of eight twice, its arm preferring nothing, a posture, or the
manipulability of the arm or of the whole robot; the backhoe, on its real drives, draws a long sine.
"""

from __future__ import annotations

import numpy as np

from backhoe.basics.inputs import choice, flag
from backhoe.whole_body import (
    SLIDES,
    Following,
    KinematicPlant,
    eight_path,
    follow,
    hand,
    manipulability_gradient,
    sine_path,
)

READY = np.array([0.0, 0.9, -1.4])
"""Posture of the small robot's arm at the start, and the one it prefers [rad]."""

DIGGING = np.array([-1.4, 0.5, -0.8, 0.0])
"""The same of the backhoe's [rad]; the bucket has 0.7 rad left."""

PREFERENCES = ("nothing", "posture", "arm", "whole")

_PULL = 1.0  # back to the posture [1/s]
_CLIMB = {"arm": 20.0, "whole": 1.0}  # up the manipulability [1/(m^3 s)]


def small_robot(preference: str = "nothing") -> Following:
    """A minute of the slides' robot, T = 0.1 s and W = 0.5, in the model that only moves.

    Args:
        preference: "nothing" for the least velocities; "posture", back to `READY`; "arm" or
            "whole", up the gradient of that manipulability.

    Raises:
        ValueError: another preference.
    """
    start = np.array([0.0, 0.0, 0.0, *READY])
    path = eight_path(
        hand(start, SLIDES), 60, length=2.2, width=2.0, height=0.16, heading=-0.75, turns=2
    )

    def prefer(q: np.ndarray) -> np.ndarray:
        if preference == "posture":
            speeds = _PULL * (READY - q[3:])
        else:
            speeds = _CLIMB[preference] * manipulability_gradient(q, SLIDES, preference)
        return np.array([0.0, 0.0, *speeds])

    none = choice(preference, "preference", PREFERENCES) == "nothing"
    return follow(
        KinematicPlant(SLIDES, start, dt=0.1), path, W=0.5, preferred=None if none else prefer
    )


def backhoe(homogeneous: bool = True, backend: str = "analytic") -> Following:
    """20 s of the backhoe with its drives and its tracks' slip, T = 10 ms and W = 0.8.

    Args:
        homogeneous: whether the arm is pulled back to `DIGGING`.
        backend: as in `simulation.open_world`.

    Raises:
        ValueError: another backend, or homogeneous is no bool.
    """
    from backhoe import simulation

    path = sine_path(hand([0.0, 0.0, 0.0, *DIGGING]), 20, length=4.0, sideways=0.4, upwards=0.2)

    def back(q: np.ndarray) -> np.ndarray:
        return np.array([0.0, 0.0, *(_PULL * (DIGGING - q[3:]))])

    preferred = back if flag(homogeneous, "homogeneous") else None
    with simulation.open_world(
        backend=backend, scene=simulation.FLAT, soil=False, q=DIGGING
    ) as world:
        return follow(simulation.WholeBodyPlant(world), path, W=0.8, preferred=preferred)
