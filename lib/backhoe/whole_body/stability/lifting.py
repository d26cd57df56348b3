"""How much it may lift: tipping load, rated load and the lifting chart as makers print it.

A load tips the machine when its moment about an edge is as large as that of all other weight.
ISO 10567 rates an excavator at three quarters of that, or at 87 % of what its drives can lift.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.arm.dynamics.terms import gravity_torques
from backhoe.arm.kinematics.forward import joint_vector
from backhoe.basics.angles import wrap
from backhoe.basics.inputs import instance, numbers
from backhoe.machine import BACKHOE, Machine
from backhoe.whole_body.stability.balance import (
    Stance,
    gravity_on_slope,
    stand,
    zero_moment_point,
)
from backhoe.whole_body.stability.polygon import EDGES, distances, support_polygon
from backhoe.whole_body.stability.terms import joint_points

TIPPING_SHARE = 0.75
"""Share of the tipping load that an excavator is rated for (ISO 10567)."""

DRIVE_SHARE = 0.87
"""Share of the load that the drives can hold that an excavator is rated for (ISO 10567)."""

OVER = {"front": -np.pi / 2, "side": 0.0}
"""Swing angle with the arm over the front or over the left side [rad]."""


class Tipping(NamedTuple):
    """Load that tips the machine [kg] and the edge over which; infinite and "" where none does.

    Both of shape (...), a number and a text for one posture.
    """

    load: NDArray | float
    edge: NDArray | str


def tipping_load(
    q: ArrayLike,
    *,
    slope: ArrayLike = 0.0,
    uphill: ArrayLike = 0.0,
    machine: Machine = BACKHOE,
) -> Tipping:
    """The mass at the bucket's centre of mass with which the machine just tips, at rest.

    Args:
        q: joint angles, shape (..., 4) [rad].
        slope, uphill: of the ground, as for `gravity_on_slope`, shape (...) [rad].
        machine: its numbers, the bucket empty.

    Returns:
        The `Tipping`, of shape (...).

    Raises:
        ValueError: a wrong shape, a value that is not finite, a slope on which the tracks slip, or
            a posture in which the machine lies already with an empty bucket.
    """
    q = joint_vector(q)
    inside = distances(
        zero_moment_point(q, slope=slope, uphill=uphill, machine=machine), support_polygon(machine)
    )
    if (inside < 0).any():
        *at, edge = np.unravel_index(inside.argmin(), inside.shape)
        where = f" at index {tuple(map(int, at))}" if at else ""
        raise ValueError(
            f"q must be a posture in which the empty machine stands, got one{where} in which it "
            f"lies: {-inside.min():.2f} m beyond its {EDGES[edge]} edge"
        )
    stance = stand(q, np.zeros(()), machine)
    *_, r, z = joint_points(stance.arm, stance.v)
    loads = _loads(inside, stance, r, z, gravity_on_slope(slope, uphill, machine), machine)
    least = loads.min(axis=-1)
    names = np.where(np.isinf(least), "", np.array(EDGES)[loads.argmin(axis=-1)])
    return Tipping(least[()], str(names) if names.ndim == 0 else names)


def _loads(
    inside: NDArray, stance: Stance, r: NDArray, z: NDArray, gravity: NDArray, machine: Machine
) -> NDArray:
    """Load at (r, z) [m] that tips over each edge, from the distances inside it, (..., 4) [kg]."""
    x, y = machine.base.offset + r * stance.out_x, r * stance.out_y
    # Where the line of the load's weight meets the ground.
    aside, down = z[..., None] * gravity[..., :2], gravity[..., 2:]
    beyond = -distances(np.stack([x, y], axis=-1) - aside / down, support_polygon(machine))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(beyond > 0, machine.mass * inside / beyond, np.inf)


@dataclass(frozen=True, eq=False)
class LiftingChart:
    """Rated loads at the stick's end, as a maker prints them.

    `radius` (m,) of the load from the swing axis and `height` (n,) above the ground [m]; `front`
    and `side` (n, m) the loads over the front and over the side [kg], NaN where the arm does not
    reach, 0 where the machine may lift nothing; `by_drives_front`, `by_drives_side` (n, m) whether
    the joints' torque and not tipping limits them.
    """

    radius: NDArray
    height: NDArray
    front: NDArray
    side: NDArray
    by_drives_front: NDArray
    by_drives_side: NDArray

    def __str__(self) -> str:
        head = "height" + "".join(f"{radius:>15.1f} m" for radius in self.radius)
        lines = ["rated load [t], over the front / over the side", head]
        for k, height in enumerate(self.height):
            cells = (
                f"{self._cell(self.front, self.by_drives_front, k, j)} /"
                f"{self._cell(self.side, self.by_drives_side, k, j)}"
                for j in range(len(self.radius))
            )
            lines.append(f"{height:4.1f} m " + "".join(f"{cell:>16}" for cell in cells))
        return "\n".join([*lines, "* the joints' torque limits it, else tipping"])

    def _cell(self, loads: NDArray, by_drives: NDArray, k: int, j: int) -> str:
        if np.isnan(loads[k, j]):
            return "     - "
        return f"{'*' if by_drives[k, j] else ''}{loads[k, j] / 1e3:.2f}".rjust(6) + " "


def lifting_chart(radius: ArrayLike, height: ArrayLike, machine: Machine = BACKHOE) -> LiftingChart:
    """Rated loads over radius and height, over the front and over the side, on level ground.

    The load hangs at the stick's end; the bucket stays on and hangs as plumb as its joint allows,
    its mass counts as the machine's. Rated is 75 % of the tipping load or 87 % of what the torques
    of boom and stick can hold, whichever is less (ISO 10567).

    Args:
        radius: from the swing axis, shape (m,) [m].
        height: above the ground, shape (n,) [m].
        machine: its numbers.

    Returns:
        The chart.

    Raises:
        ValueError: radius or height is no list of finite numbers.
    """
    instance(machine, "machine", Machine)
    radius = numbers(radius, "radius", ("m",), meaning="radii from the swing axis [m]")
    height = numbers(height, "height", ("n",), meaning="heights above the ground [m]")
    shape = len(height), len(radius)
    postures = np.full((*shape, 4), np.nan)
    for k, z in enumerate(height):
        for j, r in enumerate(radius):
            postures[k, j] = _hanging(float(r), float(z), machine)
    reached = ~np.isnan(postures[..., 0])
    found = {}
    for name, swing in OVER.items():
        loads, by_drives = np.full(shape, np.nan), np.zeros(shape, dtype=bool)
        q = postures[reached]
        q[:, 0] = swing
        loads[reached], by_drives[reached] = _rated(q, machine)
        found[name] = loads, by_drives
    (front, front_drives), (side, side_drives) = found["front"], found["side"]
    return LiftingChart(radius, height, front, side, front_drives, side_drives)


def _hanging(r: float, z: float, machine: Machine) -> NDArray:
    """Joint angles with the stick's end at (r, z) [m], the bucket below, (4,) [rad]; or NaN."""
    at = machine.base.offset + r, 0.0, z, 0.0
    try:
        q = kinematics.inverse_kinematics(at, machine=machine)
    except ValueError:
        return np.full(4, np.nan)
    stick = q[1] + machine.boom.angle_offset + q[2] + machine.stick.angle_offset
    plumb = wrap(-np.pi / 2 - machine.bucket.com_angle - stick)
    q[3] = min(max(plumb, machine.lower[3]), machine.upper[3])
    return q


def _rated(q: NDArray, machine: Machine) -> tuple[NDArray, NDArray]:
    """Rated load at the stick's end (n,) [kg], and whether the drives limit it (n,)."""
    inside = distances(zero_moment_point(q, machine=machine), support_polygon(machine))
    stance = stand(q, np.zeros(()), machine)
    arm, v = stance.arm, stance.v
    r, z = arm.b1 + v.l2r + v.l3r, arm.z1 + v.l2z + v.l3z
    tipping = _loads(inside, stance, r, z, gravity_on_slope(0.0, 0.0, machine), machine)
    g2, g3, _ = gravity_torques(arm, v)
    _, most2, most3, _ = machine.torque_limit
    held = []
    for torque, most, lever in ((g2, most2, v.l2r + v.l3r), (g3, most3, v.l3r)):
        by_load = machine.gravity * lever
        with np.errstate(divide="ignore"):
            held.append((np.copysign(most, by_load) - torque) / by_load)
    tips = TIPPING_SHARE * np.maximum(tipping.min(axis=-1), 0.0)
    holds = DRIVE_SHARE * np.maximum(np.minimum(*held), 0.0)
    return np.minimum(tips, holds), holds < tips
