"""Beams of a nodding scanner, in the axes of its mount: x ahead, y left, z up."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, number, numbers, whole
from backhoe.machine.sensors import Laser

MOST_LINES = 10**6
"""In one call: hours of a scanner."""


def beam_angles(laser: Laser) -> NDArray:
    """Angle of each beam to the middle one, from right to left, shape (beams,) [rad]."""
    half = instance(laser, "laser", Laser).field_of_view / 2
    return np.linspace(-half, half, laser.beams)


def beam_times(laser: Laser, lines: int, start: float = 0.0) -> NDArray:
    """When each beam of some lines is sent.

    The mirror turns once a line: a beam at an angle is later by its part of a turn.

    Args:
        laser: the scanner.
        lines: how many, one after the other.
        start: time of the first beam [s].

    Returns:
        Shape (lines, beams) [s].

    Raises:
        ValueError: fewer than one line, or a time that is not finite.
    """
    angles = beam_angles(laser)
    lines, start = whole(lines, "lines", least=1, most=MOST_LINES), number(start, "start", "s")
    turns = np.arange(lines)[:, None] + (angles - angles[0]) / (2 * pi)
    return start + turns / laser.line_rate


def nod_angles(laser: Laser, time: ArrayLike) -> NDArray:
    """Nod at each time, downwards, of the times' shape, such as (lines, beams) [rad].

    Args:
        laser: the scanner, at its highest at time 0.
        time: any shape [s].

    Raises:
        ValueError: a time that is not finite.
    """
    laser, time = instance(laser, "laser", Laser), numbers(time, "time")
    phase = 2 * pi * time / laser.nod_period
    return laser.nod_middle - laser.nod_amplitude * np.cos(phase)


def directions(laser: Laser, time: ArrayLike) -> NDArray:
    """Where each beam points, in the axes of the mount.

    Args:
        laser: the scanner.
        time: of each beam, shape (..., beams) [s].

    Returns:
        Vectors of length 1, shape (..., beams, 3) [1].

    Raises:
        ValueError: another number of beams, or a time that is not finite.
    """
    a = beam_angles(laser)
    nod = nod_angles(laser, numbers(time, "time", (..., laser.beams), meaning="times [s]"))
    ahead, left = np.cos(a), np.broadcast_to(np.sin(a), nod.shape)
    return np.stack([ahead * np.cos(nod), left, -ahead * np.sin(nod)], axis=-1)
