"""One dig as a try: a path goes in, what it would cost and what it brings comes out.

    one = dig(path, times, soil="loam")
    many = dig_many(paths, times)

The machine is led along the path exactly, and the soil is that of the simulation, visited as often.
What the joints must give for it follows afterwards from the equation of motion (lesson 02), with
the load in the bucket and the soil's force. So no controller has to be simulated, and a try takes a
small part of a second; a real machine lags behind where the torque that is asked for exceeds its
limit, which `Trial.saturated` counts.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass
from functools import lru_cache, partial
from multiprocessing import get_context

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import contact, dynamics, kinematics
from backhoe.arm.dynamics import terms
from backhoe.basics import inputs
from backhoe.basics.angles import wrap
from backhoe.machine import BACKHOE, Machine
from backhoe.simulation import forces, standing
from backhoe.simulation.clock import STEP, TICKS_PER_DIG
from backhoe.simulation.scene import LOADING, Scene, untouched_ground
from backhoe.simulation.soil import Ground, SoilParameters, soil_of
from backhoe.simulation.soil.bucket_pose import BucketPose
from backhoe.whole_body.stability import EDGES

TICK = TICKS_PER_DIG * STEP
"""Between two visits to the soil [s]."""

LONGEST = 600.0
"""Duration of a dig at most [s]."""

TARGET = "x, y, z of the stick's tip [m] and the bucket's angle [rad]"


@dataclass(frozen=True, eq=False)
class Trial:
    """What a dig would ask of the machine, and what it brings; m rows, one a visit to the soil.

    Attributes:
        machine: that dug.
        time: shape (m,) [s].
        q, dq: joint angles and speeds, shape (m, 4) [rad, rad/s].
        torque: that the joints must give, shape (m, 4) [N m]; it may exceed the machine's limit.
        force: of the soil on the bucket's tip, in the base frame [N], and the moment about the tip
            that raises the pitch [N m], shape (m, 4).
        volume: in the bucket, shape (m,) [m^3].
        margin: of the machine's balance, shape (m,) [m]; minus infinity where nothing would press
            on the tracks.
        tipped: edge over which it would tip, or None.
    """

    machine: Machine
    time: NDArray
    q: NDArray
    dq: NDArray
    torque: NDArray
    force: NDArray
    volume: NDArray
    margin: NDArray
    tipped: str | None

    @property
    def duration(self) -> float:
        """From the first sample of the path to its last [s]."""
        return float(self.time[-1])

    @property
    def soil(self) -> float:
        """In the bucket at the end [m^3]."""
        return float(self.volume[-1])

    @property
    def spilled(self) -> float:
        """What the bucket held at its fullest and no longer holds at the end [m^3]."""
        return float(self.volume.max() - self.volume[-1])

    @property
    def energy(self) -> float:
        """Work that the actuators give; none comes back where they brake [J]."""
        return float(np.maximum(self.torque * self.dq, 0.0).sum() * TICK)

    @property
    def peak_force(self) -> float:
        """Largest force of the soil [N]."""
        return float(np.linalg.norm(self.force[:, :3], axis=1).max())

    @property
    def peak_torque(self) -> NDArray:
        """Largest torque of each joint, shape (4,) [N m]."""
        return np.abs(self.torque).max(axis=0)

    @property
    def strain(self) -> NDArray:
        """Torque over its limit, of the joint that has the hardest work, shape (m,) [1]."""
        return (np.abs(self.torque) / self.machine.torque_limit).max(axis=1)

    @property
    def saturated(self) -> float:
        """How long a joint would have to give more than it can [s]."""
        return float((self.strain > 1.0).sum() * TICK)

    @property
    def least_margin(self) -> float:
        """Of the machine's balance [m]."""
        return float(self.margin.min())

    @property
    def speed_share(self) -> float:
        """Fastest joint's speed over its limit [1]; above 1 the path is too fast to follow."""
        return float((np.abs(self.dq) / self.machine.speed_limit).max())

    def __str__(self) -> str:
        return (
            f"{self.soil:.2f} m^3 in {self.duration:.1f} s, {self.spilled:.2f} m^3 spilled, "
            f"{self.energy / 1e3:.0f} kJ, soil's force up to {self.peak_force / 1e3:.0f} kN, "
            f"{self.saturated:.2f} s beyond a torque limit, least margin {self.least_margin:.2f} m"
            + (f", tips over its {self.tipped} edge" if self.tipped else "")
        )


def dig(
    path: ArrayLike,
    times: ArrayLike,
    *,
    scene: Scene = LOADING,
    seed: int = 0,
    soil: str | SoilParameters = "sandy loam",
    machine: Machine = BACKHOE,
    pose: ArrayLike = (0.0, 0.0, 0.0),
    ground: Ground | None = None,
) -> Trial:
    """Lead the bucket along a path and see what it digs.

    Args:
        path: stick's tip x, y, z in the base frame [m] and bucket joint's angle [rad], shape
            (n, 4), n at least 4; between its rows a cubic spline.
        times: of the rows, rising, shape (n,), or the one step between them, shape () [s]; they
            last 600 s at most.
        scene: what stands around the machine.
        seed: of the bumps on its heaps.
        soil: a name in `soil.SOILS` or `SoilParameters`.
        machine: that digs.
        pose: vehicle's x, y, heading, shape (3,) [m, m, rad].
        ground: soil to dig in, which is changed, instead of the scene's untouched ground; what is
            still in the bucket is carried off first (it counts in `Ground.off_map_volume`).

    Raises:
        ValueError: a wrong shape, a value that is not finite, times that do not rise, a path out of
            reach or beyond a joint's limits (the error says when), an unknown soil.
        TypeError: scene, machine or ground is something else.
    """
    inputs.instance(scene, "scene", Scene)
    inputs.instance(machine, "machine", Machine)
    t, q, dq, ddq = _led(path, times, machine)
    pose = inputs.numbers(pose, "pose", (3,), meaning="x, y, heading")
    if ground is None:
        seed = inputs.whole(seed, "seed", least=0)
        ground = untouched_ground(scene, machine, seed, STEP, soil_of(soil))
    else:
        inputs.instance(ground, "ground", Ground)
        ground.forget_pose()
        ground.off_map_volume += ground.bucket_volume
        ground.bucket_volume = 0.0
    felt, volume = _dug(ground, machine, pose, q, dq)
    load = volume * ground.parameters.density
    torque = _needed(machine, q, dq, ddq, felt, load)
    margin, tipped = _balanced(machine, q, dq, felt, load)
    return Trial(machine, t, q, dq, torque, felt, volume, margin, tipped)


def dig_many(
    paths: Iterable[ArrayLike],
    times: ArrayLike | Sequence[ArrayLike],
    *,
    processes: int | None = None,
    **world: object,
) -> list[Trial]:
    """The same for many paths, side by side on untouched ground; the results in their order.

    Args:
        paths: each as for `dig`.
        times: one for all, as for `dig`, or a list with those of each path [s].
        processes: how many work; default one a core. 1 stays in this process. They are kept for
            the next call: the first one waits a second or two for them. A script that is not a
            notebook needs `if __name__ == "__main__":` around its calls.
        world: scene, seed, soil, machine, pose, as for `dig`.

    Raises:
        ValueError: as for `dig`; not as many times as paths.
        TypeError: as for `dig`, or a ground, which paths side by side cannot share.
    """
    if isinstance(paths, np.ndarray):
        inputs.numbers(paths, "paths", ("k", "n", 4), meaning=TARGET)
    paths = list(inputs.instance(paths, "paths", Iterable))
    if "ground" in world:
        raise TypeError("dig_many takes no ground: each path digs its own, use dig one by one")
    each = isinstance(times, (list, tuple)) and len(times) > 0 and np.ndim(times[0]) > 0
    if each and len(times) != len(paths):
        raise ValueError(f"times must be one for each of {len(paths)} paths, got {len(times)}")
    jobs = list(zip(paths, times if each else [times] * len(paths), strict=True))
    cores = os.cpu_count() or 1
    workers = cores if processes is None else inputs.whole(processes, "processes", least=1)
    work = partial(_one, world)
    if workers == 1 or len(jobs) < 2:
        return [work(job) for job in jobs]
    return list(_pool(workers).map(work, jobs, chunksize=max(len(jobs) // (4 * workers), 1)))


def _led(path: ArrayLike, times: ArrayLike, machine: Machine) -> tuple[NDArray, ...]:
    """Times of the visits from 0 on, and joint angles, speeds and accelerations then."""
    from scipy.interpolate import CubicSpline

    path = inputs.numbers(path, "path", ("n", 4), meaning=TARGET)
    if inputs.real_numbers(times, "times").ndim == 0:
        times = inputs.positive(times, "times", "s") * np.arange(len(path))
    times = inputs.times(times, "times", least=4)
    inputs.numbers(path, "path", (len(times), 4), meaning=f"{TARGET} at each of the times")
    inputs.number(times[-1] - times[0], "the duration of times", "s", most=LONGEST)
    t = np.arange(round((times[-1] - times[0]) / TICK) + 1) * TICK
    if len(t) < 4:
        raise ValueError(f"a path must last {3 * TICK} s or more, got {times[-1] - times[0]} s")
    targets = CubicSpline(times - times[0], path)(t)
    q = kinematics.inverse_kinematics(targets, machine=machine, on_failure="nan")
    lost = np.flatnonzero(np.isnan(q).any(axis=1))
    if len(lost):
        k = int(lost[0])
        try:
            kinematics.inverse_kinematics(targets[k], machine=machine)
        except ValueError as error:
            raise ValueError(
                f"path must be in reach, {t[k]:.2f} s after its start: {error}"
            ) from error
    q[:, 0] = np.unwrap(q[:, 0])
    joints = CubicSpline(t, q)
    return t, q, joints(t, 1), joints(t, 2)


def _dug(
    ground: Ground, machine: Machine, pose: NDArray, q: NDArray, dq: NDArray
) -> tuple[NDArray, NDArray]:
    """Force and moment at the tip, base frame, (m, 4) [N, N m]; soil in the bucket, (m,) [m^3]."""
    reach, placed = forces.numbers_of(machine, True).reach, np.empty((7, len(q)))
    placed[:3], placed[3:] = pose[:, None], q.T
    *_, r, z, pitch = forces.arm_points(reach, placed)
    ahead = pose[2] + q[:, 0] + np.pi / 2
    out = np.column_stack([np.cos(ahead), np.sin(ahead)])
    turned = _turned(pose[2])
    axis = pose[:2] + turned @ [reach[0], 0.0]
    rates = (contact.contact_jacobian(q, machine) @ dq[..., None])[..., 0]
    moving = np.column_stack([rates[:, :2] @ turned.T, rates[:, 2]]).tolist()
    tips = np.column_stack([axis + r[:, None] * out, z]).tolist()
    felt, volume = np.empty((len(q), 4)), np.empty(len(q))
    way = zip(tips, out.tolist(), wrap(pitch).tolist(), moving, rates[:, 3].tolist(), strict=True)
    for k, (tip, heading, pitch_now, velocity, turning) in enumerate(way):
        now = BucketPose(tuple(tip), tuple(heading), pitch_now)
        felt[k, :3] = ground.move(now, velocity, TICK, turning)
        felt[k, 3], volume[k] = ground.moment, ground.bucket_volume
    felt[:, :2] = felt[:, :2] @ turned
    return felt, volume


def _turned(heading: float) -> NDArray:
    """From the base frame's x and y to the world's, shape (2, 2) [1]."""
    c, s = np.cos(heading), np.sin(heading)
    return np.array([[c, -s], [s, c]])


def _needed(
    machine: Machine, q: NDArray, dq: NDArray, ddq: NDArray, felt: NDArray, load: NDArray
) -> NDArray:
    """Torques (m, 4) [N m] for a motion with a load (m,) [kg] against soil (m, 4), base frame.

    The joints' friction is that of the simulation, smooth through zero speed.
    """
    arm = terms.arm_of(machine)
    arm = arm._replace(m_bu=arm.m_bu + load)
    pitches = np.cumsum(q[:, 1:] + [arm.o2, arm.o3, arm.o4], axis=1).T
    turned = [function(pitch) for pitch in pitches for function in (np.cos, np.sin)]
    motion = np.stack(terms.newton_euler(arm, terms.vectors(arm, *turned), *dq.T, *ddq.T), axis=1)
    friction = dynamics.friction_torque(dq, machine, forces.COULOMB_SMOOTHING)
    return motion + friction - contact.joint_torque(q, felt, machine)


def _balanced(
    machine: Machine, q: NDArray, dq: NDArray, felt: NDArray, load: NDArray
) -> tuple[NDArray, str | None]:
    """Margin of the balance (m,) [m] and the edge over which it tips, in the base frame."""
    from backhoe.simulation import engine

    masses, memory = standing.masses_of(machine), np.zeros(standing.MEMORY)
    balance, tipped = standing.balance_in(memory), None
    states = np.zeros((len(q), 14))
    states[:, 3:7], states[:, 10:] = q, dq
    balance.before[:] = states[0]
    margin = np.empty(len(q))
    for k, state in enumerate(states):
        masses[-1] = machine.bucket.mass + load[k]
        edge = engine.stand(masses, state, felt[k], memory, k, TICK)
        margin[k] = balance.margin[0]
        if edge >= 0 and tipped is None:
            tipped = EDGES[edge]
    return margin, tipped


def _one(world: dict[str, object], job: tuple[ArrayLike, ArrayLike]) -> Trial:
    return dig(*job, **world)


@lru_cache(maxsize=1)
def _pool(workers: int) -> Executor:
    return ProcessPoolExecutor(workers, mp_context=get_context("spawn"))
