"""The plan of a trench: layer after layer, and its bottom graded while the tracks creep backwards.

The machine stands over the line of the trench, on ground that is not dug yet, and digs towards
itself. Each stroke takes a layer along the whole bay, goes up a ramp at its near end, and curls the
bucket there; the last two go along the bottom itself. A trench that is longer than a bay is dug in
several, the far one first, so the tracks never stand on what is dug.

Walls slump to the soil's angle of repose, and with each layer their foot moves out: a bottom of the
bucket's width is narrower by some centimetres at each side.
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

LOAD = 0.65
"""Soil that a layer may have [m^3]; walls that slump add to it, and the bucket holds 0.76."""

FINISH = 0.04
"""What the layers leave for the first of the last two strokes [m]."""

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
        ValueError: a bottom wider than the bucket, or a trench too deep for its reach.
    """
    if design.width > machine.shell.width:
        raise ValueError(
            f"the trench must not be wider than the bucket, {machine.shell.width:g} m, got "
            f"{design.width:g} m: it is dug in one line"
        )
    deepest = design.depth + max(design.fall, 0.0) * design.length
    ramp = RAMP[0] + RAMP[1] * deepest
    behind = ramp + CLEAR + machine.tracks.length / 2 - machine.base.offset
    longest = REACH[0] - BEYOND - behind
    if longest < machine.shell.width:
        raise ValueError(f"a trench {deepest:.2f} m deep is out of reach behind its ramp")
    bays = ceil(design.length / longest - 1e-9)
    size = design.length / bays
    layers = max(ceil(machine.shell.width * deepest * (size + ramp) / LOAD), 1)
    above = [*np.linspace(deepest, 0.0, layers + 1)[1:-1], FINISH, 0.0, 0.0]
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
