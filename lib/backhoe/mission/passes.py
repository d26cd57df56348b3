"""The plan of a slope: which way the bucket's edge takes, pass after pass, and where the tracks go.

The machine stands at the foot and faces the bank. A pass draws the edge from the crest down to the
foot, a bit out on the flat ground, and curls the bucket there. The earth goes before the edge and
into the bucket. The arm alone does not reach all that way, so each point of the way has a reach,
from the swing axis to the edge, at which the arm works well: the tracks keep it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, degrees, pi, radians, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.machine import BACKHOE, Machine
from backhoe.mission.design import SlopeDesign

SPEED = 1.2
"""Of the edge on its way [m/s]; the bounds of joints and tracks allow less on most of it."""

CURLING = 0.7
"""Largest speed of the bucket's pitch [rad/s]."""

ROUNDED = 0.16
"""Corners of the way are rounded over this time [s]."""

LANES = (-0.5, 0.5, 0.5, -0.5, 0.0)
"""Where the passes lie across a slope, as shares of the bucket's width from the middle line [1]:
half a bucket side by side, and at last down the middle, where the two leave a ridge."""

CLEARANCE = radians(5)
"""Between the bucket's floor and the slope at its foot [rad]."""

STAND_OFF = 0.25
"""From the front of the tracks to the foot when the edge is at the crest [m]."""

NEAR = 0.5
"""How much further than the nearest that the arm can is the edge at the foot [m]."""

AT_CREST = tuple(map(radians, (-75, -70, -65, -60, -55, -50, -45, -80, -85, -90, -95, -100)))
"""Pitches for the crest [rad]: the first at which the arm reaches it, flatter where it is far,
steeper where it is near."""


@dataclass(frozen=True, eq=False)
class Stroke:
    """One way of the edge.

    Attributes:
        name: for the replay.
        goals: edge x, y, z [m], pitch [rad] and reach [m] every period, shape (n, 5).
        stand: of the vehicle at its begin, x, y, heading, shape (3,) [m, m, rad].
        side: where the bucket is emptied, +1 left and -1 right.
    """

    name: str
    goals: NDArray
    stand: NDArray
    side: float


def slope_strokes(
    design: SlopeDesign, period: float, machine: Machine = BACKHOE, lanes: tuple = LANES
) -> list[Stroke]:
    """The passes over a slope.

    Args:
        design: of the slope.
        period: between two goals [s].
        machine: that grades it.
        lanes: where they lie across, as shares of the bucket's width [1].

    Raises:
        ValueError: the arm does not reach the crest from before the foot, or the foot from there.
    """
    run, crest = design.run, design.crest
    front = machine.tracks.length / 2 - machine.base.offset
    far = run + 0.1 + front + STAND_OFF
    floor = atan2(*machine.shell.profile[1][::-1])
    flat = design.angle - floor + CLEARANCE
    near = _nearest(0.0, flat, machine) + NEAR
    above = [(far, crest, steep) for steep in AT_CREST], [(far, crest + 0.5, s) for s in AT_CREST]
    reached = ~np.isnan([edge_posture(edges, machine)[:, 0] for edges in above]).any(axis=0)
    if not reached.any():
        raise ValueError(
            f"the slope is out of reach: with the tracks {STAND_OFF} m before its foot, the edge "
            f"would have to be {far:.2f} m from the swing axis at its crest, {crest:.2f} m high"
        )
    steep = AT_CREST[int(np.argmax(reached))]
    turned = 0.6 * run
    # along the slope and above it [m], pitch [rad], reach [m]
    knots = np.array(
        [
            (run + 0.1, 0.5, steep, far),
            (run + 0.04, 0.0, steep, far),
            (run - turned, 0.0, flat, far + (near - far) * turned / run),
            (0.0, 0.0, flat, near),
            (-0.9, 0.02, flat - radians(3), near),
            (-1.5, 0.25, radians(-165), near - 0.2),
            (-1.5, 1.5, -pi, near - 0.4),
        ]
    )
    uphill = np.array([cos(design.direction), sin(design.direction)])
    strokes = []
    for number, lane in enumerate(lanes, start=1):
        on = np.maximum(knots[:, 0], 0)  # before the foot the ground is level
        points = design.point(on, lane * machine.shell.width)
        points[:, :2] += (knots[:, 0] - on)[:, None] * uphill
        points[:, 2] += knots[:, 1]
        stand = np.append(points[0, :2] - (far + machine.base.offset) * uphill, design.direction)
        goals = timed(np.c_[points, knots[:, 2:]], period)
        strokes.append(Stroke(f"pass {number}", goals, stand, -1.0 if lane < 0 else 1.0))
    check_reach(strokes[0], machine)
    return strokes


def timed(knots: NDArray, period: float, speed: ArrayLike = SPEED) -> NDArray:
    """Goals every period along straight lines between knots, corners rounded, rest at both ends.

    Args:
        knots: x, y, z [m], pitch [rad], reach [m], shape (n, 5).
        period: between two goals [s].
        speed: of the edge, on all of the way or shape (n - 1,) [m/s].

    Returns:
        Shape (m, 5), the same columns.
    """
    change = np.abs(np.diff(knots, axis=0))
    length = np.linalg.norm(change[:, :3], axis=1)
    times = np.r_[0.0, np.cumsum(np.maximum(length / speed, change[:, 3] / CURLING))]
    half = round(ROUNDED / 2 / period)
    t = period * np.arange(-2 * half, round(times[-1] / period) + 2 * half + 1)
    way = np.stack([np.interp(t, times, column) for column in knots.T], axis=1)
    summed = np.cumsum(np.vstack([np.zeros(5), way]), axis=0)
    return (summed[2 * half + 1 :] - summed[: -2 * half - 1]) / (2 * half + 1)


def edge_posture(edge: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """Joint angles that put the bucket's edge somewhere ahead, the arm pointing forward.

    Args:
        edge: reach from the swing axis [m], height [m] and pitch [rad], shape (..., 3).
        machine: whose arm.

    Returns:
        Shape (..., 4) [rad]; NaN where the arm does not reach, or a joint would leave its range.
    """
    reach, z, pitch = np.moveaxis(np.asarray(edge, dtype=float), -1, 0)
    length, zero = machine.bucket.length, np.zeros_like(reach)
    x = machine.base.offset + reach - length * np.cos(pitch)
    wrist = np.stack([x, zero, z - length * np.sin(pitch), zero], axis=-1)
    q = kinematics.inverse_kinematics(wrist, machine=machine, on_failure="nan")
    offsets = sum(link.angle_offset for link in machine.links)
    q[..., 3] = pitch - q[..., 1] - q[..., 2] - offsets
    inside = (q[..., 3] >= machine.lower[3]) & (q[..., 3] <= machine.upper[3])
    return np.where(inside[..., None], q, np.nan)


def check_reach(stroke: Stroke, machine: Machine = BACKHOE) -> None:
    """See that the arm can do a stroke.

    Raises:
        ValueError: somewhere it does not reach, or a joint would leave its range.
    """
    edges = stroke.goals[:, [4, 2, 3]]
    lost = np.isnan(edge_posture(edges, machine)[:, 0])
    if lost.any():
        reach, z, pitch = edges[np.argmax(lost)]
        raise ValueError(
            f"{stroke.name} is out of reach: no posture has the edge {reach:.2f} m from the swing "
            f"axis, {z:.2f} m high, at a pitch of {degrees(pitch):.0f} deg"
        )


def _nearest(z: float, pitch: float, machine: Machine) -> float:
    """Least reach at which the edge can be at a height [m] and pitch [rad]."""
    reach = np.arange(0.5, 12.0, 0.05)
    edges = np.stack([reach, np.full_like(reach, z), np.full_like(reach, pitch)], axis=-1)
    possible = ~np.isnan(edge_posture(edges, machine)[:, 0])
    if not possible.any():
        raise ValueError(
            f"the foot is out of reach at the pitch it needs, {degrees(pitch):.0f} deg, at which "
            "the bucket's floor is clear of the slope"
        )
    return float(reach[np.argmax(possible)])
