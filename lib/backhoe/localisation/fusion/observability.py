"""Which directions of the state no measurement shows, along a drive.

Linearised along a drive without noise, with the slip among the unknowns, and the gyro's bias if
there is a gyro.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, numbers
from backhoe.localisation import kalman
from backhoe.localisation.drives import truth
from backhoe.localisation.fusion.model import BIAS, NAMES, PSI, TURNED, TURNING, Model, X, Y

SEEN = ("rate", "yaw", "position", "landmark")
_STEP = 1.0


class Unobservable(NamedTuple):
    """`unknown` names of n states; `directions` (n, r) of them that no measurement shows,
    orthonormal columns; `names` of the states that these move."""

    unknown: tuple[str, ...]
    directions: NDArray
    names: tuple[str, ...]


def unobservable(
    name: str, seen: Sequence[str], *, landmark: ArrayLike = (3.0, 20.0)
) -> Unobservable:
    """What cannot be found out on a drive, however long one measures.

    Args:
        name: one of drives.SCENARIOS.
        seen: what is measured besides the encoders, out of SEEN: the gyro's "rate", the absolute
            "yaw", a fix of the "position", range and bearing to a "landmark".
        landmark: its x, y, shape (2,) [m].

    Returns:
        The unknowns and the directions of them that no measurement shows; none if r = 0.

    Raises:
        ValueError: nothing is seen, or something that is not in SEEN; an unknown scenario.
    """
    if isinstance(seen, str) or not seen:
        raise ValueError(f"seen must be a sequence of names out of {SEEN}, got {seen!r}")
    for item in seen:
        choice(item, "seen", SEEN)
    point = numbers(landmark, "landmark", (2,), meaning="x, y [m]")
    model, pose = Model(), truth(name, 1 / _STEP).pose
    keep = [i for i in range(TURNED) if i != BIAS or "rate" in seen]
    state = np.zeros(6)
    state[:3], state[TURNING] = pose[0], 1.0
    F, H = [], []
    for change in np.diff(pose, axis=0):
        sides = np.hypot(change[0], change[1]) + model.gauge / 2 * change[2] * np.array([-1, 1])
        sprockets = sides / model.radius
        step = model.F(state, sprockets, _STEP)
        state = model.f(state, sprockets, _STEP)
        F.append(step[np.ix_(keep, keep)])
        H.append(_sensors(model, state, step, point, seen)[:, keep])
    directions = kalman.unobservable(F[1:], H)
    unknown = tuple(NAMES[i] for i in keep)
    moved = np.abs(directions).max(axis=1, initial=0.0) > 1e-6
    names = tuple(name for name, moves in zip(unknown, moved, strict=True) if moves)
    return Unobservable(unknown, directions, names)


def _sensors(
    model: Model, state: NDArray, step: NDArray, point: NDArray, seen: Sequence[str]
) -> NDArray:
    """Rows of H at the state after a step, one sensor under another."""
    turn = model.H_gyro(_STEP)
    turn[0, TURNED], turn[0, TURNING] = 0.0, step[PSI, TURNING]
    rows = {
        "rate": turn,
        "yaw": model.H_YAW,
        "position": model.H_POSITION,
        "landmark": _range_and_bearing(*(point - state[:2])),
    }
    return np.vstack([rows[item] for item in seen])


def _range_and_bearing(to_x: float, to_y: float) -> NDArray:
    """Jacobian of range and bearing of a point that lies that far away, shape (2, 6)."""
    far, H = np.hypot(to_x, to_y), np.zeros((2, 6))
    H[0, X], H[0, Y] = -to_x / far, -to_y / far
    H[1, X], H[1, Y], H[1, PSI] = to_y / far**2, -to_x / far**2, -1.0
    return H
