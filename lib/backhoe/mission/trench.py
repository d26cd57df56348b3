"""The plan of a trench: layer after layer, and its bottom graded while the tracks creep backwards.

The machine stands over the line of the trench, on ground that is not dug yet, and digs towards
itself. Each stroke takes a layer along the whole bay, goes up a ramp at its near end, and curls the
bucket there; the last ones, two or more, go along the bottom itself. A trench that is longer than a
bay is dug in several, the far one first, so the tracks never stand on what is dug.

Walls slide to the soil's angle of repose, so no trench has upright ones here. Each layer takes what
has slid in, and the foot of the walls moves out: at last it is some centimetres inside the bucket's
width, and a bottom may not be wider than that.
"""

from __future__ import annotations

from math import ceil, cos, radians, sin

import numpy as np
from numpy.typing import NDArray

from backhoe.machine import Machine
from backhoe.mission.design import TrenchDesign
from backhoe.mission.passes import Stroke, check_reach, timed

REACH = 6.9, 3.8, 5.6
"""From the swing axis to the edge: far end at most, near end, far end at least [m]."""

LOAD, WALLS = 0.75, 0.75
"""Soil that a layer may have [m^3]: the bucket holds 0.76; and what slides in from both walls, as a
share of the depth squared [1], half of what it is in all: the last strokes take the rest."""

FINISH = 0.04
"""What the layers leave for the first of the last two strokes [m]."""

AGAIN = 0.4, 0.2
"""Below this depth the bottom is graded once more for each so many metres: walls slide in [m]."""

FOOT = 0.1
"""How far the walls slide in from each side of the bucket after the last stroke, at most [m]."""

BEYOND = 0.3
"""How far behind the far end of a bay the edge goes down [m]."""

RAMP = 0.4, 1.5
"""The bucket comes out so far before the near end of a bay [m], and further with the depth [1]."""

CLEAR = 0.15
"""Between the tracks and where the bucket comes out [m]."""

SPEEDS = np.array([0.6, 0.2, 0.5, 0.4, 0.4, 0.4])
"""Of the edge: down to the ground, into it, along the bottom, up the ramp, out and up [m/s]."""

FAR, NEAR, CURLED = radians(-100), radians(-135), radians(-178)
"""Pitch of the bucket at the far and the near end of a bay, and where it comes out."""


def trench_strokes(design: TrenchDesign, machine: Machine, period: float) -> list[Stroke]:
    """The strokes that dig a trench and grade its bottom.

    Args:
        design: its bottom.
        machine: that digs.
        period: between two goals [s].

    Raises:
        ValueError: a bottom too wide for the bucket, or a trench too deep for its reach.
    """
    widest = machine.shell.width - 2 * FOOT
    if design.width > widest + 1e-9:
        raise ValueError(
            f"the bottom must not be wider than {widest:.2f} m, got {design.width:g} m: it is dug "
            "in one line, and the walls slide in at both sides of the bucket"
        )
    deepest = design.depth + max(design.fall, 0.0) * design.length
    ramp = RAMP[0] + RAMP[1] * deepest
    behind = ramp + CLEAR + machine.tracks.length / 2 - machine.base.offset
    longest = REACH[0] - BEYOND - behind
    if longest < machine.shell.width:
        raise ValueError(f"a trench {deepest:.2f} m deep is out of reach behind its ramp")
    bays = ceil(design.length / longest - 1e-9)
    size = design.length / bays
    section = machine.shell.width * deepest + WALLS * deepest**2
    layers = ceil(section * (size + ramp) / LOAD)
    last = 2 + ceil(max(deepest - AGAIN[0], 0.0) / AGAIN[1] - 1e-9)
    above = [*np.linspace(deepest, 0.0, layers + 1)[1:-1], FINISH, *np.zeros(last)]
    strokes = []
    for bay in reversed(range(bays)):
        near, far = bay * size, (bay + 1) * size
        reach = max(far - near + BEYOND + behind, REACH[2])
        for layer, over in enumerate(above):
            knots = _knots(near, far, over, reach, ramp, deepest)
            points = design.point(knots[:, 0])
            points[:, 2] += knots[:, 1]
            direction = np.array([cos(design.heading), sin(design.heading)])
            stand = points[0, :2] - (reach + machine.base.offset) * direction
            strokes.append(
                Stroke(
                    (f"bay {bays - bay}, " if bays > 1 else "") + f"layer {layer + 1}",
                    timed(np.c_[points, knots[:, 2:]], period, SPEEDS),
                    np.r_[stand, design.heading],
                    1.0 if layer % 2 else -1.0,
                )
            )
            check_reach(strokes[-1], machine)
    return strokes


def _knots(near: float, far: float, over: float, reach: float, ramp: float, deep: float) -> NDArray:
    """Of a layer `over` the bottom: along, above the bottom [m], pitch [rad] and reach [m]."""
    _, close, _ = REACH
    return np.array(
        [
            (far + BEYOND, deep + 1.0, FAR, reach),
            (far + BEYOND, over + 0.3, FAR, reach),
            (far + BEYOND, over, FAR, reach),
            (near - 0.1, over, NEAR, close),
            (near - 0.4, over + 0.2, NEAR - radians(20), close - 0.1),
            (near - ramp, max(over + 0.55, deep + 0.2), CURLED, close - 0.4),
            (near - ramp, deep + 1.5, CURLED, close - 0.4),
        ]
    )
