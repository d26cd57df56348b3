"""What will go wrong with a path, said before the machine moves.

A path is what a primitive gives: x, y, z of the stick's tip in the base frame and the bucket's
angle, over time. What can be said of it without a machine: where it cannot be reached and what
could be instead, and then, of the path that can be driven, how fast its joints must be, how far
the balance stays from the tracks' edges and how near the arm comes to what the map holds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics import FRAMES, forward_kinematics, inverse_kinematics
from backhoe.basics import inputs
from backhoe.machine import BACKHOE, JOINTS, Machine
from backhoe.perception.distance_field import DistanceField

__all__ = ["Foresight", "foresee", "nearest_reachable"]

FAR = 1e6
"""Largest coordinate that is accepted [m]."""

LEAST_STEP = 1e-4
"""Between two samples; with less the differences of rounded angles are no speeds [s]."""

ROUNDING = 1e-9
"""Ways and shares within it count as none [m, rad, 1]."""


@dataclass(frozen=True, eq=False)
class Foresight:
    """What a path of n samples asks of the machine; `str` says it in words.

    Attributes:
        times: of the samples, shape (n,) [s].
        nearest: the path that can be reached, sample by sample as near as can be, shape (n, 4)
            [m, rad]; `q` its joint angles, shape (n, 4) [rad].
        out_by: how far the stick's tip of the path is from it, shape (n,) [m].
        bucket_out_by: how far the bucket's joint is beyond its limits, shape (n,) [rad].
        use: of the joints' speed limits, shape (n, 4) [1].
        margin: distance of the balance from the nearest edge, shape (n,) [m], and the names of
            these `edge`s; None where it was not asked for.
        clearance: from the arm to the map's obstacles, shape (n,) [m], or None.
        least_margin, least_clearance: what was asked for [m].
    """

    times: NDArray
    nearest: NDArray
    q: NDArray
    out_by: NDArray
    bucket_out_by: NDArray
    use: NDArray
    margin: NDArray | None
    edge: NDArray | None
    clearance: NDArray | None
    least_margin: float
    least_clearance: float

    @property
    def ok(self) -> bool:
        """Whether nothing speaks against the path."""
        return not self.reasons

    @property
    def reasons(self) -> list[str]:
        """What speaks against the path, each at its worst moment."""
        out, turned, found = self.out_by, self.bucket_out_by, []
        if out.max() > ROUNDING:
            k, (x, y, z) = out.argmax(), self.nearest[out.argmax(), :3]
            found.append(
                f"out of reach by up to {out[k]:.3f} m at {self.times[k]:.2f} s, where the nearest "
                f"that can be reached is ({x:.2f}, {y:.2f}, {z:.2f}) m"
            )
        if turned.max() > ROUNDING:
            k = turned.argmax()
            found.append(
                f"the bucket is asked for {np.degrees(turned[k]):.1f} deg beyond its limit at "
                f"{self.times[k]:.2f} s"
            )
        if self.use.max() > 1 + ROUNDING:
            k, joint = np.unravel_index(self.use.argmax(), self.use.shape)
            found.append(
                f"the {JOINTS[joint]} would need {self.use[k, joint]:.2f} times its greatest speed "
                f"at {self.times[k]:.2f} s: take {self.use.max():.2f} times as long"
            )
        if self.margin is not None and self.margin.min() < self.least_margin:
            k = self.margin.argmin()
            found.append(
                f"the balance is {self.margin[k]:.2f} m inside the {self.edge[k]} edge at "
                f"{self.times[k]:.2f} s, at least {self.least_margin:.2f} m is asked for"
            )
        if self.clearance is not None and self.clearance.min() < self.least_clearance:
            k = self.clearance.argmin()
            found.append(
                f"the arm is {self.clearance[k]:.2f} m from an obstacle at {self.times[k]:.2f} s, "
                f"at least {self.least_clearance:.2f} m is asked for"
            )
        return found

    def __str__(self) -> str:
        return "nothing speaks against it" if self.ok else "\n".join(self.reasons)


def foresee(
    path: ArrayLike,
    times: ArrayLike,
    machine: Machine = BACKHOE,
    *,
    margin: Callable | None = None,
    field: DistanceField | None = None,
    spheres: Mapping[str, ArrayLike] | None = None,
    least_margin: float = 0.0,
    least_clearance: float = 0.0,
) -> Foresight:
    """Look at a whole path before it is driven.

    Args:
        path: x, y, z of the stick's tip in the base frame and the bucket joint's angle, shape
            (n, 4), n at least 2 [m, rad].
        times: of its samples, rising, shape (n,), or the step between them [s].
        machine: whose arm it is.
        margin: gives how far it is from tipping over, called `margin(q, dq, ddq, machine=...)` as
            `whole_body.stability.margin`; None asks no such thing.
        field: distances to what the map holds, in the base frame; None for free space.
        spheres: that cover the arm: frame ("swing", "boom", "stick", "tip") -> middles in that
            frame and radii, shape (k, 4) [m]. Needed with a field.
        least_margin, least_clearance: less of these is reported [m].

    Returns:
        The `Foresight`. Speeds are central differences over the samples.

    Raises:
        ValueError: shapes, times that do not rise, values that are not finite, a field without
            spheres or an unknown frame.
        TypeError: margin is no function, field no DistanceField, machine no Machine.
    """
    path = _path(path)
    inputs.whole(len(path), "samples of the path", least=2)
    if inputs.real_numbers(times, "times").ndim == 0:
        times = inputs.positive(times, "times", "s") * np.arange(len(path))
    times = inputs.times(times, "times")
    if len(times) != len(path):
        raise ValueError(f"times must be one for each of {len(path)} samples, got {len(times)}")
    inputs.number(np.diff(times).min(), "the least step of times", "s", least=LEAST_STEP)
    nearest, q = nearest_reachable(path, machine)
    dq = np.gradient(q, times, axis=0)
    distance, edge = None, None
    if margin is not None:
        ddq = np.gradient(dq, times, axis=0)
        form = "margin(q, dq, ddq, machine=...) -> distance [m], edge"
        inputs.function(margin, "margin", form)
        try:
            distance, edge = margin(q, dq, ddq, machine=machine)
        except Exception as error:
            raise ValueError(f"margin must answer, {form}: {error}") from error
        distance = inputs.numbers(distance, "the distance of margin", (len(q),), finite=False)
    return Foresight(
        times,
        nearest,
        q,
        np.linalg.norm(path[:, :3] - nearest[:, :3], axis=1),
        np.abs(path[:, 3] - nearest[:, 3]),
        np.abs(dq) / machine.speed_limit,
        distance,
        edge,
        None if field is None else _clearance(q, machine, field, spheres),
        inputs.number(least_margin, "least_margin", "m"),
        inputs.number(least_clearance, "least_clearance", "m"),
    )


def nearest_reachable(path: ArrayLike, machine: Machine = BACKHOE) -> tuple[NDArray, NDArray]:
    """The reachable target nearest to each wanted one, within the joints' limits, elbow up.

    What the stick's tip can reach in the arm's plane is bounded by four arcs: of the boom about
    its joint with the stick at either end of its range, and of the stick with the boom at one.

    Args:
        path: x, y, z of the stick's tip [m] and the bucket's angle [rad], shape (n, 4).
        machine: whose arm it is.

    Returns:
        The targets, shape (n, 4) [m, rad], and their joint angles, shape (n, 4) [rad].

    Raises:
        ValueError: another shape or a value that is not finite.
        TypeError: machine is no Machine.
    """
    path = _path(path)
    inputs.instance(machine, "machine", Machine)
    low, high = machine.lower, machine.upper
    wanted = path.copy()
    wanted[:, 3] = np.clip(path[:, 3], low[3], high[3])
    q = inverse_kinematics(wanted, limits=True, machine=machine, on_failure="nan")
    for k in np.flatnonzero(np.isnan(q[:, 0])):
        q[k] = _nearest(wanted[k], machine)
        wanted[k, :3] = forward_kinematics(q[k], "stick", machine)[:3, 3]
    return wanted, q


def _path(path: ArrayLike) -> NDArray:
    meaning = "x, y, z [m] and bucket angle [rad]"
    return inputs.numbers(path, "path", ("n", 4), meaning=meaning, within=FAR)


def _nearest(target: NDArray, machine: Machine) -> NDArray:
    """Joint angles of the nearest place that can be reached: ahead, or at an end of the swing."""
    x, y, z, bucket = target
    x -= machine.base.offset
    low, high = machine.lower[0], machine.upper[0]
    ahead = np.arctan2(-x, y)
    best, least = None, np.inf
    for swing in [ahead] if low <= ahead <= high else [low, high]:
        c, s = np.cos(swing), np.sin(swing)
        r, aside = y * c - x * s, y * s + x * c
        inside = [machine.base.offset - r * s, r * c, z, bucket]
        q, off = inverse_kinematics(inside, "up", machine, True, "nan"), 0.0
        if np.isnan(q[0]) or r <= 0:
            (boom, stick), off = _in_plane(r, z, machine)
            q = np.array([swing, boom, stick, bucket])
        if np.hypot(off, aside) < least:
            best, least = q, np.hypot(off, aside)
    return best


def _in_plane(r: float, z: float, machine: Machine) -> tuple[tuple[float, float], float]:
    """Boom and stick angle on the nearest of the four arcs [rad], and how far off that is [m]."""
    wanted = r - machine.swing.offset + 1j * (z - machine.base.height - machine.swing.height)
    (low, fold), (high, stretch) = machine.lower[1:3], machine.upper[1:3]
    o2, o3 = machine.boom.angle_offset, machine.stick.angle_offset
    fold, stretch = max(fold, -np.pi - o3), min(stretch, -o3)  # elbow up

    def end(boom: float, stick: float) -> complex:
        along = np.exp(1j * (boom + o2))
        return along * (machine.boom.length + machine.stick.length * np.exp(1j * (stick + o3)))

    found = []
    for stick in (fold, stretch):
        found.append((_on_arc(np.angle(wanted / end(0.0, stick)), low, high), stick))
    for boom in (low, high):
        along = np.exp(1j * (boom + o2))
        stick = np.angle(wanted / along - machine.boom.length) - o3
        found.append((boom, _on_arc(stick, fold, stretch)))
    off = [abs(end(*angles) - wanted) for angles in found]
    return found[int(np.argmin(off))], min(off)


def _on_arc(angle: float, low: float, high: float) -> float:
    """The angle of an arc that is nearest to a direction, over either end [rad]."""
    middle = (low + high) / 2
    turn = (angle - middle + np.pi) % (2 * np.pi) - np.pi
    return middle + min(max(turn, low - middle), high - middle)


def _clearance(q: NDArray, machine: Machine, field: DistanceField, spheres: Mapping) -> NDArray:
    inputs.instance(field, "field", DistanceField)
    advice = "a field needs spheres that cover the arm: frame -> (k, 4) [m]"
    if not inputs.instance({} if spheres is None else spheres, "spheres", Mapping, advice):
        raise ValueError(f"spheres must not be none: {advice}")
    least = np.full(len(q), np.inf)
    for frame, given in spheres.items():
        inputs.choice(frame, "frame of spheres", FRAMES)
        balls = inputs.numbers(given, f"spheres of {frame}", ("k", 4), meaning="middle, radius [m]")
        T = forward_kinematics(q, frame, machine)
        middles = balls[:, :3] @ T[:, :3, :3].swapaxes(1, 2) + T[:, None, :3, 3]
        distance, _ = field.query(middles, beyond=np.inf)
        least = np.minimum(least, (distance - balls[:, 3]).min(axis=1))
    return least
