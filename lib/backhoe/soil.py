"""Soil that moves: the bucket digs, carries, spills and fills a truck; volume is kept throughout.

    ground = soil.Ground(terrain, bed)
    force = ground.advance(T_tip, tip_velocity, 0.01)      # 100 times a second
    force = ground.force(tip_position, tip_velocity)       # as often as you like in between

World frame: x forward, y left, z up. T_tip is the pose of the bucket's tip frame: origin at the
teeth, x from the pin through the teeth, y towards the back plate, z across. Terrain: `terrain`.
Cutting force: `earthmoving`. What the bucket holds: `bucket_fill`. The loops: `soil_kernels`.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, ceil, hypot, inf, isfinite, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.bucket_fill import BucketFill
from backhoe.earthmoving import LOAM, SoilParameters, bearing_capacity
from backhoe.machine import BACKHOE, Machine
from backhoe.terrain import Terrain

__all__ = ["LOAM", "Ground", "SoilParameters", "Terrain"]

SWEEPS_PER_ADVANCE = 4
"""How many cells far loose soil slides in one advance."""
POINTS_ACROSS = 13
"""Points on the bucket's width where soil falls and the depth is measured."""
EMPTYING_TIME = 0.15
"""Time constant of the last of the outflow [s]."""
EDGE = 0.04
"""Thickness of the teeth [m]."""
CREEP = 0.15
"""Speed at which soil resistance has reached 70 % of its full value [m/s]."""
LONGEST_TICK = 1.0
"""A tip that moves further than this in one advance [m] was put there, not driven."""


@dataclass(frozen=True)
class Placed:
    """The bucket in the world: tip (x, y, z) [m], heading of the arm's plane, pitch [rad]."""

    tip: tuple[float, float, float]
    heading: tuple[float, float]
    pitch: float


@dataclass
class Resistance:
    """What `force` needs between two advances: the soil's strength around the bucket as it is now.

    Limits [N] of `cutting` forces, sideways and tooth-first; stiffness [N/m], damping [N s/m] and
    limit [N] of the ground under the shell, which is `sunk` [m] into it with the tip at `level`.
    """

    cutting: float = 0.0
    sideways: float = 0.0
    teeth: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0
    bearing: float = 0.0
    sunk: float = 0.0
    level: float = 0.0
    at: Placed | None = None


class Ground:
    """All the soil of a scene: on the ground, in the bucket and in the truck.

    Args:
        terrain: the ground; it is settled to the angle of repose.
        bed: the truck's bed (`Terrain.bed`), or None.
        parameters: strength and weight of the soil.
        machine: gives the bucket's shell and gravity.
        hold: how long the simulation keeps a force before it asks again [s]; the force is softened
            so that a force held that long cannot make the bucket chatter. Use the simulation's
            step with `force`, and the default when only `advance` is called.

    Attributes:
        bucket_volume: in the bucket [m^3].
        off_map_volume: fallen beside the map [m^3]; it counts in `total_volume`.

    Raises:
        TypeError: terrain or bed is no Terrain.
        ValueError: hold is not positive.
    """

    def __init__(
        self,
        terrain: Terrain,
        bed: Terrain | None = None,
        parameters: SoilParameters = LOAM,
        machine: Machine = BACKHOE,
        *,
        hold: float = 0.01,
    ) -> None:
        for name, field in (("terrain", terrain), ("bed", bed)):
            if not (isinstance(field, Terrain) or (name == "bed" and field is None)):
                raise TypeError(f"{name} must be a soil.Terrain, got {type(field).__name__}")
        if not 0 < hold < inf:
            raise ValueError(f"hold must be a positive time in s, got {hold!r}")
        self.terrain, self.bed = terrain, bed
        self.parameters, self.machine = parameters, machine
        self.fill = BucketFill(machine.shell, parameters.repose)
        self.bucket_volume = 0.0
        self.off_map_volume = 0.0
        self._profile = np.array(machine.shell.profile)
        self._half = machine.shell.width / 2
        self._mouth = float(np.linalg.norm(self._profile[-1] - self._profile[0]))
        self._floor_angle = atan2(*(self._profile[1] - self._profile[0])[::-1])
        self._before: Placed | None = None
        self._felt = Resistance()
        self._no_bed = Terrain(np.zeros((2, 2)), 1.0), np.empty((0, 0))
        self._soften(hold)
        terrain.relax(parameters.repose)

    def _soften(self, hold: float) -> None:
        """Bound stiffness and damping by what the lightest effective mass at the tip allows."""
        bucket, soil = self.machine.bucket, self.parameters
        inertia = bucket.inertia + bucket.mass * bucket.com_radius**2
        self._mass = inertia / bucket.length**2
        sole = self.machine.shell.width * self._mouth / 2
        self._hold = hold
        self._stiffness = min(soil.subgrade, self._mass / (4 * hold**2 * sole))
        self._damping = 0.3 * self._mass / (hold * sole)
        self._yield = bearing_capacity(0.0, soil, self.machine.gravity)
        self._give = self._yield / self._stiffness

    @property
    def truck_volume(self) -> float:
        """Soil in the truck [m^3]."""
        return self.bed.volume if self.bed is not None else 0.0

    @property
    def total_volume(self) -> float:
        """All soil, wherever it is [m^3]: constant."""
        return (
            self.terrain.volume + self.bucket_volume + self.truck_volume + self.off_map_volume
        )

    @property
    def payload(self) -> float:
        """Mass of the soil in the bucket [kg]."""
        return self.bucket_volume * self.parameters.density

    def advance(self, T_tip: ArrayLike, tip_velocity: ArrayLike, dt: float) -> NDArray:
        """Move the soil on by one tick: cut, fill, spill, slide.

        Args:
            T_tip: pose of the bucket's tip frame in the world, shape (4, 4).
            tip_velocity: velocity of the tip in the world, shape (3,) [m/s].
            dt: time since the last call [s].

        Returns:
            Force of the soil on the bucket at its tip, world frame, shape (3,) [N].

        Raises:
            ValueError: wrong shape, a value that is not finite, dt not positive, the arm's plane
                not upright, or a tip that has jumped by more than 1 m (see `forget_pose`).
        """
        now = _placed(T_tip)
        velocity = _vector("tip_velocity", tip_velocity)
        if not 0 < dt < inf:
            raise ValueError(f"dt must be a positive time in s, got {dt!r}")
        before = self._before or now
        if hypot(*(a - b for a, b in zip(now.tip, before.tip, strict=True))) > LONGEST_TICK:
            raise ValueError(
                f"the tip jumped from {before.tip} to {now.tip} m in one advance: after "
                "placing the machine by hand call forget_pose()"
            )
        area, sunk = self._dig(before, now)
        self._spill(now, dt)
        self._settle()
        self._feel(now, velocity, area, sunk)
        self._before = now
        return self.force(now.tip, velocity)

    def forget_pose(self) -> None:
        """Start a new path: the machine was put elsewhere without digging its way there."""
        self._before = None

    def force(self, tip_position: ArrayLike, tip_velocity: ArrayLike) -> NDArray:
        """Force on the bucket as felt at the last advance, for the tip's position and speed now.

        Cheap, so that a simulation can ask each millisecond; nothing moves.

        Args:
            tip_position: in the world, shape (3,) [m].
            tip_velocity: in the world, shape (3,) [m/s].

        Returns:
            Force at the tip, world frame, shape (3,) [N].
        """
        felt = self._felt
        if felt.at is None:
            return np.zeros(3)
        ex, ey = felt.at.heading
        vx, vy, vz = (float(value) for value in tip_velocity)
        along, across = vx * ex + vy * ey, vx * ey - vy * ex
        lifting = max(vz, 0.0)
        cutting = self._opposing(felt.cutting, hypot(along, lifting))
        c, s = np.cos(felt.at.pitch), np.sin(felt.at.pitch)
        tooth_first = max(along * c + vz * s, 0.0)
        teeth = self._opposing(felt.teeth, tooth_first) * tooth_first
        sunk = felt.sunk + felt.level - float(tip_position[2])
        up = felt.stiffness * sunk - felt.damping * vz if felt.stiffness else 0.0
        f_along = -cutting * along - teeth * c
        f_up = -cutting * lifting - teeth * s + min(max(up, 0.0), felt.bearing)
        f_across = -self._opposing(felt.sideways, abs(across)) * across
        return np.array([f_along * ex + f_across * ey, f_along * ey - f_across * ex, f_up])

    def _opposing(self, limit: float, speed: float) -> float:
        """Coefficient k of the force -k v, whose size grows smoothly from 0 to `limit` [N s/m]."""
        if limit <= 0.0:
            return 0.0
        creep = max(CREEP, limit * self._hold / self._mass)
        return limit / sqrt(speed * speed + creep * creep)

    def _dig(self, before: Placed, now: Placed) -> tuple[float, float]:
        """Take what the edge cuts; returns area [m^2] and depth [m] of the shell on the ground."""
        if min(now.tip[2], before.tip[2]) - self.machine.bucket.length > self.terrain.top:
            return 0.0, 0.0
        if now.tip[2] + self._turned(now.pitch)[1].min() > self.terrain.top:
            return 0.0, 0.0
        turn = abs(_wrapped(now.pitch - before.pitch)) + abs(_bearing_change(before, now))
        path = hypot(*(a - b for a, b in zip(now.tip, before.tip, strict=True)))
        steps = max(ceil((path + turn * self._mouth) / (self.terrain.cell / 2)), 1)
        last, area, sunk = before, 0.0, 0.0
        for step in range(1, steps + 1):
            here = _between(before, now, step / steps) if step < steps else now
            area, sunk = self._dig_step(last, here)
            last = here
        return area, sunk

    def _dig_step(self, last: Placed, here: Placed) -> tuple[float, float]:
        from backhoe.soil_kernels import dig

        ground = self.terrain
        shell_u, shell_z = self._turned(here.pitch)
        grid = (*ground.origin, ground.cell)
        cut, pressed, area, sunk, covered = dig(
            ground.heights, ground.floor, ground.ceiling, grid, ground.box,
            shell_u, shell_z + here.tip[2], last.tip, here.tip, here.heading,
            self._half, self._give,
        )  # fmt: skip
        if cut > 0.0 or pressed > 0.0:
            ground.version += 1
            self._stow(last, here, cut, pressed, (float(shell_u.min()), float(shell_u.max())))
        self._covered = covered
        return area, sunk

    def _turned(self, pitch: float) -> tuple[NDArray, NDArray]:
        c, s = np.cos(pitch), np.sin(pitch)
        x, y = self._profile[:, 0], self._profile[:, 1]
        return x * c - y * s, x * s + y * c

    def _stow(
        self,
        last: Placed,
        here: Placed,
        cut: float,
        pressed: float,
        reach: tuple[float, float],
    ) -> None:
        """Cut soil goes through the mouth while there is room, the rest is pushed away."""
        (ex, ey), margin = here.heading, 1.5 * self.terrain.cell
        dx, dy, dz = (a - b for a, b in zip(here.tip, last.tip, strict=True))
        along, across = dx * ex + dy * ey, dx * ey - dy * ex
        mouth_along, mouth_up = np.sin(here.pitch), -np.cos(here.pitch)
        if along * mouth_along + dz * mouth_up >= 0.0:
            taken = min(cut, max(self.fill.heaped - self.bucket_volume, 0.0))
            self.bucket_volume += taken
            ahead = -margin if mouth_along < 0 else margin
            self._heap_up(here, (ahead, -self._half), (ahead, self._half), cut - taken)
        else:
            pressed += cut
        if pressed <= 0.0:
            return
        if abs(along) > abs(dz) and abs(along) > abs(across):
            side = reach[0] - margin if along < 0 else reach[1] + margin
            self._heap_up(here, (side, -self._half), (side, self._half), pressed)
        else:
            beside = self._half + margin
            sides = (-beside, beside)
            if abs(across) > abs(dz):
                sides = (beside,) if across > 0 else (-beside,)
            for v in sides:
                self._heap_up(here, (reach[0], v), (reach[1], v), pressed / len(sides))

    def _heap_up(
        self,
        here: Placed,
        start: tuple[float, float],
        end: tuple[float, float],
        volume: float,
        height: float = -inf,
    ) -> None:
        """Lay a volume down along a line given by (u, v) in the bucket's heading."""
        if volume <= 0.0:
            return
        from backhoe.soil_kernels import pour

        (x, y, _), (ex, ey) = here.tip, here.heading
        line = [(x + u * ex + v * ey, y + u * ey - v * ex) for u, v in (start, end)]
        ground, bed = self.terrain, self.bed
        no_bed, nothing = self._no_bed
        truck = bed or no_bed
        self.off_map_volume += pour(
            ground.heights, (*ground.origin, ground.cell), ground.box,
            truck.heights if bed else nothing, (*truck.origin, truck.cell), truck.box,
            line[0], line[1], height, volume, POINTS_ACROSS,
        )  # fmt: skip
        ground.version += 1
        truck.version += 1

    def _spill(self, now: Placed, dt: float) -> None:
        """Let go of what the bucket cannot hold at its pitch, over the lower lip."""
        if self.bucket_volume <= 0.0:
            return
        shell_u, shell_z = self._turned(now.pitch)
        surplus = self.bucket_volume - self.fill.retained(now.pitch, self._support(now))
        if surplus <= 0.0:
            return
        flow = min(self.parameters.spill_rate, surplus / EMPTYING_TIME)
        falls = min(flow * dt, surplus)
        if self.bucket_volume - falls < 1e-9:
            falls = self.bucket_volume
        self.bucket_volume -= falls
        outside = self.terrain.cell if np.sin(now.pitch) > 0 else -self.terrain.cell
        lip, height = (0.0, 0.0) if shell_z[-1] >= 0 else (float(shell_u[-1]), float(shell_z[-1]))
        place = lip + outside
        self._heap_up(
            now, (place, -self._half), (place, self._half), falls, now.tip[2] + height
        )

    def _support(self, now: Placed) -> float:
        """Height of the soil in front of the mouth above the teeth [m]."""
        if now.tip[2] > self.terrain.top:
            return 0.0
        from backhoe.soil_kernels import cut_depth

        ahead = 2 * self.terrain.cell * (1 if np.sin(now.pitch) > 0 else -1)
        return self._depth(cut_depth, now, ahead)

    def _depth(self, cut_depth, now: Placed, u: float) -> float:
        ground = self.terrain
        grid = (*ground.origin, ground.cell)
        return cut_depth(ground.heights, grid, now.tip, now.heading, u, self._half, POINTS_ACROSS)

    def _settle(self) -> None:
        """Let loose soil slide a few cells; the truck's overflow falls beside it."""
        repose, ground, bed = self.parameters.repose, self.terrain, self.bed
        ground.relax(repose, SWEEPS_PER_ADVANCE)
        covered = getattr(self, "_covered", None)
        if covered is not None:
            ground.ceiling[covered[0] : covered[1], covered[2] : covered[3]] = inf
            self._covered = None
        if bed is not None and not bed.settled:
            from backhoe.soil_kernels import overflow

            bed.relax(repose, SWEEPS_PER_ADVANCE)
            self.off_map_volume += overflow(
                bed.heights, bed.floor, (*bed.origin, bed.cell),
                ground.heights, (*ground.origin, ground.cell), ground.box,
            )  # fmt: skip
            ground.version += 1

    def _feel(self, now: Placed, velocity: list[float], area: float, sunk: float) -> None:
        """Note the soil's strength around the bucket for `force`."""
        felt = self._felt = Resistance(at=now, level=now.tip[2], sunk=sunk)
        if area > 0.0:
            felt.stiffness, felt.damping = self._stiffness * area, self._damping * area
            felt.bearing = self._yield * area
        if now.tip[2] > self.terrain.top:
            return
        from backhoe.soil_kernels import cut_depth

        soil, gravity = self.parameters, self.machine.gravity
        along = velocity[0] * now.heading[0] + velocity[1] * now.heading[1]
        mouth_side = 1.0 if np.sin(now.pitch) > 0 else -1.0
        side = mouth_side if abs(along) < 0.02 else np.copysign(1.0, along)
        depth = self._depth(cut_depth, now, 1.5 * side * self.terrain.cell)
        if depth <= 0.0:
            return
        width, face = 2 * self._half, _wrapped(now.pitch + self._floor_angle)
        load = soil.density * gravity * self.bucket_volume / (width * self._mouth)
        felt.cutting = soil.cutting_force(
            depth, face if side < 0 else pi - face, width, load * (side == mouth_side), gravity
        )
        felt.sideways = soil.cutting_force(depth, pi / 2, self._mouth, 0.0, gravity)
        felt.teeth = EDGE * width * bearing_capacity(depth, soil, gravity)

    def snapshot(self) -> dict[str, object]:
        """A copy of everything that changes."""
        return {
            "terrain": self.terrain.snapshot(),
            "bed": None if self.bed is None else self.bed.snapshot(),
            "bucket_volume": self.bucket_volume,
            "off_map_volume": self.off_map_volume,
            "before": self._before,
            "felt": self._felt,
        }

    def restore(self, snapshot: dict[str, object]) -> None:
        """Return to a snapshot of this ground.

        Raises:
            ValueError: the snapshot is of another scene.
        """
        if (snapshot["bed"] is None) != (self.bed is None):
            raise ValueError("snapshot and ground must agree about having a truck bed")
        self.terrain.restore(snapshot["terrain"])
        if self.bed is not None:
            self.bed.restore(snapshot["bed"])
        self.bucket_volume = snapshot["bucket_volume"]
        self.off_map_volume = snapshot["off_map_volume"]
        self._before, self._felt = snapshot["before"], snapshot["felt"]


def _placed(T_tip: ArrayLike) -> Placed:
    T = np.asarray(T_tip, dtype=float)
    if T.shape != (4, 4):
        raise ValueError(f"T_tip must be a pose of shape (4, 4), got shape {T.shape}")
    rows = T.tolist()
    if not all(isfinite(value) for row in rows for value in row):
        raise ValueError("T_tip must be finite")
    across_x, across_y = rows[0][2], rows[1][2]
    level = hypot(across_x, across_y)
    x_up, y_up = rows[2][0], rows[2][1]
    if level < 0.5 or abs(x_up * x_up + y_up * y_up + rows[2][2] ** 2 - 1) > 1e-6:
        raise ValueError(
            "T_tip must be a rotation and a position with its third axis across an upright arm, "
            f"got third row {rows[2]}"
        )
    tip = (rows[0][3], rows[1][3], rows[2][3])
    return Placed(tip, (-across_y / level, across_x / level), atan2(x_up, y_up))


def _vector(name: str, values: ArrayLike) -> list[float]:
    vector = np.asarray(values, dtype=float)
    if vector.shape != (3,):
        raise ValueError(f"{name} must have shape (3,), got {vector.shape}")
    listed = vector.tolist()
    if not all(isfinite(value) for value in listed):
        raise ValueError(f"{name} must be finite, got {listed}")
    return listed


def _wrapped(angle: float) -> float:
    return (angle + pi) % (2 * pi) - pi


def _bearing_change(before: Placed, now: Placed) -> float:
    (a, b), (c, d) = before.heading, now.heading
    return atan2(a * d - b * c, a * c + b * d)


def _between(before: Placed, now: Placed, part: float) -> Placed:
    tip = tuple(a + part * (b - a) for a, b in zip(before.tip, now.tip, strict=True))
    turn = part * _bearing_change(before, now)
    (ex, ey), c, s = before.heading, np.cos(turn), np.sin(turn)
    pitch = before.pitch + part * _wrapped(now.pitch - before.pitch)
    return Placed(tip, (float(c * ex - s * ey), float(s * ex + c * ey)), pitch)
