"""Lines of the machine's lasers while it moves: what they measure, and the truth.

A beam is wide: seven rays stand for it, one in its middle and six around, each for a seventh of its
round spot. Where they meet things at several distances it measures one range: the mean of those
within `Laser.echo` of the nearest. That is how points arise where nothing is (mixed pixels).
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, cos, inf, pi, sin

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import instance, number, whole
from backhoe.machine.sensors import LASERS, STEREO, Laser, Mount, sensor_pose
from backhoe.perception.camera import Pinhole
from backhoe.perception.laser import Motion, beam_times, directions, sensor_poses
from backhoe.simulation.protocol import World
from backhoe.simulation.render import link_frames
from backhoe.simulation.sight import Sight

TOGETHER = 1e-3
"""Time for which the machine is taken to stand while rays are cast; the sensor moves on [s]."""

MIXED = 0.1
"""How far off a range must be to be called mixed [m]."""

_RING = np.array([[cos(a), sin(a)] for a in np.arange(6) * pi / 3])
_RING_RADIUS = 0.75
"""Where the six rays are, of the spot's radius: half of their light is further out."""


@dataclass(frozen=True, eq=False)
class Scan:
    """Lines of one laser.

    Attributes:
        laser: which.
        time: of each beam, shape (lines, beams) [s].
        ranges: as measured, shape (lines, beams) [m]; NaN where nothing came back.
        truth: to what the middle of the beam meets, without noise, shape (lines, beams) [m].
        surface: what that is, the index in `Sight.names`, -1 for nothing, (lines, beams).
    """

    laser: Laser
    time: NDArray
    ranges: NDArray
    truth: NDArray
    surface: NDArray

    @property
    def mixed(self) -> NDArray:
        """Which ranges are more than `MIXED` from the truth, shape (lines, beams) [1]."""
        return np.abs(self.ranges - self.truth) > MIXED


class Scanner:
    """The machine's lasers in one simulation.

        scanner = Scanner(world)
        scans = scanner.sweep()  # standing: half a nod of each laser, {"left": Scan, ...}

        while world.time < 5:  # moving
            world.step(torque)
            scanner.follow()
        scans, motion = scanner.take()

    Args:
        world: with either backend.
        lasers: by name; default `LASERS`.
        seed: of the noise of the ranges.
        sight: the scene, if it is open already.
    """

    def __init__(
        self,
        world: World,
        lasers: dict[str, Laser] | None = None,
        seed: int = 0,
        sight: Sight | None = None,
    ) -> None:
        self.sight = Sight(world) if sight is None else sight
        self.lasers = dict(LASERS if lasers is None else lasers)
        self._world = world
        self._rng = np.random.default_rng(whole(seed, "seed", least=0))
        self._log = [(world.time, world.q.copy(), world.pose.copy())]
        self._cast = dict.fromkeys(self.lasers, 0)
        self._lines: dict[str, list[Scan]] = {name: [] for name in self.lasers}
        self._start = world.time

    @property
    def names(self) -> tuple[str, ...]:
        """What `Scan.surface` counts."""
        return self.sight.names

    def sweep(self, start: float | None = None) -> dict[str, Scan]:
        """Half a nod of each laser from now, with the machine and the soil as they stand.

        `start` is the time of the first beam [s], now by default; at whole nods' periods the lines
        come from the highest to the lowest.
        """
        world = self._world
        motion = Motion.standing(world.q, world.pose)
        start = world.time if start is None else number(start, "start", "s")
        return {
            name: self.scan(laser, motion, laser.sweep_lines, start)
            for name, laser in self.lasers.items()
        }

    def scan(self, laser: Laser, motion: Motion, lines: int, start: float = 0.0) -> Scan:
        """Lines of one laser while the machine moves as said; the soil stays as it is now.

        Args:
            laser: which.
            motion: of the machine, whatever the world does.
            lines: how many.
            start: time of the first beam [s].
        """
        laser, motion = instance(laser, "laser", Laser), instance(motion, "motion", Motion)
        time = beam_times(laser, lines, start)
        poses = sensor_poses(laser.mount, time, motion, self._world.machine)
        foot, rays = _spread(laser, directions(laser, time))
        R = np.swapaxes(poses[..., :3, :3], -1, -2)
        start, vector = foot @ R + poses[..., None, :3, 3], rays @ R
        t, surface = np.empty(vector.shape[:-1]), np.empty(vector.shape[:-1], dtype=int)
        for part in _moments(time, motion):
            frames = motion.link_poses(float(time[part].mean()), self._world.machine)
            caster = self.sight.caster(frames)
            some = start[part].reshape(-1, 3), vector[part].reshape(-1, 3)
            hits = caster.cast(*some, laser.most)
            t[part] = hits.t.reshape(t[part].shape)
            surface[part] = hits.surface.reshape(t[part].shape)
        ranges = _echo(t, laser) + laser.noise * self._rng.standard_normal(time.shape)
        ranges[~((ranges >= laser.least) & (ranges <= laser.most))] = np.nan
        truth = np.where(np.isfinite(t[..., 0]), t[..., 0], np.nan)
        return Scan(laser, time, ranges, truth, surface[..., 0])

    def follow(self) -> None:
        """Note where the machine is now and cast all lines that ended since the last call.

        Call it after every step or every few: in between the machine is taken to move evenly.

        Raises:
            RuntimeError: the world's time went back.
        """
        world = self._world
        if world.time < self._log[-1][0]:
            raise RuntimeError("the world's time went back: open a Scanner for each run")
        if world.time == self._log[-1][0]:
            return
        self._log.append((world.time, world.q.copy(), world.pose.copy()))
        for name, laser in self.lasers.items():
            part = laser.field_of_view / (2 * pi)
            done = int(np.floor((world.time - self._start) * laser.line_rate - part + 1e-9)) + 1
            new = done - self._cast[name]
            if new > 0:
                start = self._start + self._cast[name] / laser.line_rate
                self._lines[name].append(self.scan(laser, self._motion(start), new, start))
                self._cast[name] = done

    def take(self) -> tuple[dict[str, Scan], Motion]:
        """The lines since the last `take`, and the machine's true motion meanwhile.

        Raises:
            RuntimeError: no line has ended yet.
        """
        if not all(self._lines.values()):
            raise RuntimeError("no line has ended yet: step the world and follow() it first")
        scans = {
            name: Scan(
                self.lasers[name],
                *(np.concatenate([getattr(s, key) for s in parts]) for key in _ARRAYS),
            )
            for name, parts in self._lines.items()
        }
        motion = self._motion()
        self._log = self._since(max(scan.time[-1, -1] for scan in scans.values()))
        self._lines = {name: [] for name in self.lasers}
        return scans, motion

    def _motion(self, start: float = -inf) -> Motion:
        return Motion(*map(np.array, zip(*self._since(start), strict=True)))

    def _since(self, start: float) -> list[tuple[float, NDArray, NDArray]]:
        """What is noted from the last time before start on."""
        return self._log[max(bisect_right(self._log, start, key=lambda row: row[0]) - 1, 0) :]


_ARRAYS = ("time", "ranges", "truth", "surface")


def pose_now(world: World, mount: Mount) -> NDArray:
    """Pose of a sensor in the world as it stands, shape (4, 4) [1, m]."""
    return sensor_pose(link_frames(world)[mount.link], mount)


def stereo_now(world: World) -> tuple[Pinhole, NDArray, NDArray]:
    """The stereo pair's camera and the poses of the left and the right one, (4, 4) each [1, m]."""
    camera = Pinhole.of_view(STEREO.size, STEREO.field_of_view)
    return camera, pose_now(world, STEREO.mount), pose_now(world, STEREO.right)


def _moments(time: NDArray, motion: Motion) -> list[tuple]:
    """Parts of (lines, beams) during which the machine is taken to stand."""
    if motion.still:
        return [(slice(None), slice(None))]
    lines, beams = time.shape
    blocks = ceil((time[0, -1] - time[0, 0]) / TOGETHER)
    edges = np.linspace(0, beams, blocks + 1).astype(int)
    return [
        (slice(line, line + 1), slice(a, b)) for line in range(lines) for a, b in pairwise(edges)
    ]


def _spread(laser: Laser, beams: NDArray) -> tuple[NDArray, NDArray]:
    """Starts [m] and directions [1] of the rays that stand for beams (..., 3): (..., 7, 3) each.

    The middle one comes first; the spot's diameter is `spot` + `divergence` range.
    """
    up = np.cross(beams, [0.0, 1.0, 0.0])
    up /= np.linalg.norm(up, axis=-1, keepdims=True)
    ring = _RING_RADIUS / 2 * _RING @ np.stack([np.cross(beams, up), up], axis=-2)
    ring = np.concatenate([np.zeros_like(ring[..., :1, :]), ring], axis=-2)
    rays = beams[..., None, :] + laser.divergence * ring
    return laser.spot * ring, rays / np.linalg.norm(rays, axis=-1, keepdims=True)


def _echo(t: NDArray, laser: Laser) -> NDArray:
    """One range for the rays of each beam, (..., 7) to (...) [m]; NaN where none meets anything."""
    near = t.min(axis=-1, keepdims=True)
    counts = np.isfinite(t) & (t <= near + laser.echo)
    total = np.where(counts, t, 0.0).sum(axis=-1)
    return np.divide(total, counts.sum(axis=-1), out=np.full(total.shape, np.nan), where=total > 0)
