"""From a running simulation, or from arrays of joint angles, to a `Replay`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive
from backhoe.machine import BACKHOE, Machine
from backhoe.view.replay import stage
from backhoe.view.replay.page import Replay
from backhoe.view.replay.recording import HeightField, Line, Recording, Scalar

_ROVER_CAMERA = (2.9, -2.6, 1.9), (0.4, 0.2, 0.2)


class Recorder:
    """Watches a simulation and keeps at most `rate` frames a second.

    The world is read only: `machine`, `time` [s], `q` (4,) [rad], `pose` (3,) = x, y [m], yaw
    [rad], and where it has them `ground` (a `soil.Ground`) and `scene` (its truck). Or it is a
    rover, with `vehicle`, `time`, `wheel_angles` (4,) [rad] and `pose`.

    Raises:
        ValueError: the rate is not a positive number.
    """

    def __init__(self, world: object, rate: float = 30.0) -> None:
        self.world, self.rate = world, positive(rate, "rate", "frames a second")
        self._rover = hasattr(world, "wheel_angles")
        self._times: list[float] = []
        self._q: list[np.ndarray] = []
        self._poses: list[np.ndarray] = []
        self._volumes: list[tuple[float, float]] = []
        self._fields: list[HeightField] = []
        self._labels: list[tuple[float, str]] = []
        self._due = -np.inf

    def capture(self) -> bool:
        """Keep a frame if 1/rate has passed since the last one; says whether it did.

        Raises:
            ValueError: the simulation's time ran backwards, or its state is not finite.
        """
        time = self.world.time
        if time < self._due:
            if self._times and time < self._times[-1]:
                raise ValueError(
                    f"time ran backwards from {self._times[-1]} s to {time} s: "
                    "start a new Recorder after a reset"
                )
            return False
        self._keep(time)
        return True

    def label(self, text: str) -> None:
        """Show `text` from the present time on, such as "swing to the truck"."""
        self._labels.append((float(self.world.time), str(text)))

    def replay(
        self,
        *,
        title: str,
        alt: str,
        lines: tuple[Line, ...] = (),
        poster: float | None = None,
        camera: tuple[ArrayLike, ArrayLike] | None = None,
        belief: tuple[ArrayLike, ArrayLike] | None = None,
    ) -> Replay:
        """What was recorded so far, the present moment included.

        Args:
            title: a few words.
            alt: what happens, in a sentence or two, for those who do not see it.
            lines: fixed lines to draw in the world, such as a planned path.
            poster: time of the frame shown before playing [s]; the first one if None.
            camera: eye and target at first, in the world, shape (3,) each [m]; None for near by.
            belief: where the machine believes to be, shown as the outline of its tracks on the
                ground: times (n,) [s] and poses (n, 3) [m, m, rad]; None for no outline.

        Raises:
            ValueError: nothing was recorded, title or alt are empty, or camera is malformed.
        """
        if not self._times:
            raise ValueError("nothing was recorded: call capture() in the simulation's loop first")
        if self.world.time > self._times[-1]:
            self._keep(self.world.time)
        if self._rover:
            recording = _rover_recording(
                self._times, self._q, self._poses, self.world.vehicle, lines, tuple(self._labels)
            )
            return Replay(_seen_from(camera, recording), title=title, alt=alt, poster=poster)
        ground = getattr(self.world, "ground", None)
        scalars = ()
        if ground is not None:
            bucket, truck = np.array(self._volumes).T
            scalars = (Scalar("bucket", bucket, "bucket", "m³"),)
            if len(self._fields) > 1:
                scalars += (Scalar("truck", truck, "truck", "m³"),)
        recording = _recording(
            self._times,
            self._q,
            self._poses,
            self.world.machine,
            scene=getattr(self.world, "scene", None),
            fields=tuple(self._fields),
            scalars=scalars,
            lines=lines,
            labels=tuple(self._labels),
        )
        if belief is not None:
            times, poses = np.asarray(belief[0], float), np.asarray(belief[1], float)
            columns = (poses[:, 0], poses[:, 1], np.unwrap(poses[:, 2]))
            shown = np.column_stack([np.interp(self._times, times, one) for one in columns])
            ghost = stage.belief_node(shown, self.world.machine)
            recording = replace(recording, nodes=(*recording.nodes, ghost))
        return Replay(_seen_from(camera, recording), title=title, alt=alt, poster=poster)

    def _keep(self, time: float) -> None:
        q = self.world.wheel_angles if self._rover else self.world.q
        q = np.array(numbers(q, f"the simulation's q at {time} s"))
        pose = np.array(numbers(self.world.pose, f"the simulation's pose at {time} s"))
        ground = getattr(self.world, "ground", None)
        if ground is not None:
            self._keep_ground(ground)
        self._times.append(float(time))
        self._q.append(q)
        self._poses.append(pose)
        frames = np.floor((time - self._times[0]) * self.rate + 1e-6) + 1
        self._due = self._times[0] + frames / self.rate - 1e-9

    def _keep_ground(self, ground: object) -> None:
        heights = [ground.terrain.heights]
        if ground.bed is not None:
            heights.append(_load(ground.bed))
        if not self._fields:
            grids = [("ground", ground.terrain, 0.0), ("bed", ground.bed, _bottom(ground.bed))]
            self._fields = [
                HeightField(name, z, grid.cell, grid.origin, bed=name == "bed", level=level)
                for z, (name, grid, level) in zip(heights, grids, strict=False)
            ]
        else:
            for field, z in zip(self._fields, heights, strict=True):
                field.append(z)
        self._volumes.append((float(ground.bucket_volume), float(ground.truck_volume)))


def _bottom(bed: object) -> float:
    return 0.0 if bed is None else float(bed.floor.min())


def _load(bed: object) -> NDArray:
    """Height of the soil above the bed's bottom [m], zero where there is none."""
    return np.where(bed.heights > bed.floor, bed.heights - _bottom(bed), 0.0)


def from_joints(
    times: ArrayLike,
    q: ArrayLike,
    *,
    title: str,
    alt: str,
    poses: ArrayLike | None = None,
    bucket: ArrayLike | None = None,
    machine: Machine = BACKHOE,
    lines: tuple[Line, ...] = (),
    labels: tuple[tuple[float, str], ...] = (),
    poster: float | None = None,
) -> Replay:
    """A replay of given motions, without any simulation.

    Args:
        times: rising, shape (frames,) [s].
        q: joint angles, shape (frames, 4) [rad].
        title: a few words.
        alt: what happens, in a sentence or two, for those who do not see it.
        poses: x, y [m] and yaw [rad] of the base, shape (frames, 3); standing still if None.
        bucket: volume in the bucket, shape (frames,) [m^3], if it is to be shown.
        machine: its numbers.
        lines: fixed lines to draw in the world, such as a planned path.
        labels: (time [s], text) to show from that time on.
        poster: time of the frame shown before playing [s]; the first one if None.

    Raises:
        ValueError: no frame, times that do not rise, shapes that do not agree, values that are not
            finite, or an empty title or alt.
    """
    times = numbers(times, "times", ("n",))
    q = numbers(q, "q", (times.size, 4), meaning="swing, boom, stick, bucket for each time")
    poses = np.zeros((times.size, 3)) if poses is None else poses
    poses = numbers(poses, "poses", (times.size, 3), meaning="x, y, yaw for each time")
    scalars = () if bucket is None else (Scalar("bucket", bucket, "bucket", "m³"),)
    recording = _recording(times, q, poses, machine, scalars=scalars, lines=lines, labels=labels)
    return Replay(recording, title=title, alt=alt, poster=poster)


def _seen_from(camera: tuple[ArrayLike, ArrayLike] | None, recording: Recording) -> Recording:
    if camera is None:
        return recording
    points = numbers(camera, "camera", (2, 3), meaning="eye and target, (x, y, z) each [m]")
    return replace(recording, camera=(points[0], points[1]))


def _rover_recording(
    times: ArrayLike,
    angles: ArrayLike,
    poses: ArrayLike,
    vehicle: object,
    lines: tuple[Line, ...],
    labels: tuple[tuple[float, str], ...],
) -> Recording:
    return Recording(
        times=times,
        nodes=stage.rover_nodes(angles, poses, vehicle),
        lines=lines,
        labels=labels,
        camera=_ROVER_CAMERA,
        follow=stage.ROVER,
        trail=stage.ROVER,
    )


def _recording(
    times: ArrayLike,
    q: ArrayLike,
    poses: ArrayLike,
    machine: Machine,
    *,
    scene: object = None,
    fields: tuple[HeightField, ...] = (),
    scalars: tuple[Scalar, ...] = (),
    lines: tuple[Line, ...] = (),
    labels: tuple[tuple[float, str], ...] = (),
) -> Recording:
    loaded = any(scalar.name == "bucket" for scalar in scalars)
    return Recording(
        times=times,
        nodes=(
            *stage.machine_nodes(q, poses, machine, loaded),
            *stage.strut_nodes(q, machine),
            *stage.truck_node(scene),
        ),
        fields=fields,
        scalars=scalars,
        lines=lines,
        labels=labels,
        follow=stage.TIP,
        trail=stage.TIP,
    )
