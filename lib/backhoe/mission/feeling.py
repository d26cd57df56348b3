"""Digging that feels: the machine weighs what pushes at its bucket and gives way in time.

A hundred times a second the joints' torques are compared with what the motion needs (lesson 02);
what is missing is the push at the tip (`arm.contact`), the soil that the bucket carries included.
The strain is that push over the largest like it that joints and tracks could hold here. Above
`START` the primitive slows down and is lifted, at `STOP` it stands, beyond it goes back on its way:

    ds/dt = rate(strain),   dh/dt = RISE (1 - rate), or -h / FORGET where nothing presses,
    reference = primitive(s) + (0, 0, h, 0).

In the primitive's own equation h is a coupling force K h on the height, whose spring follows within
some hundredths of a second. A push that holds the bucket down says that it hangs under something:
then it goes back before it is lifted. Nothing here knows where a rock lies.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe import simulation
from backhoe.arm import contact, dynamics, kinematics, pid
from backhoe.basics import inputs
from backhoe.machine import BACKHOE, Machine
from backhoe.mission.records import Record, recorder_of
from backhoe.simulation.clock import TICKS_PER_DIG as STEPS
from backhoe.simulation.forces import COULOMB_SMOOTHING
from backhoe.simulation.scene import LOADING, Scene
from backhoe.simulation.soil import SoilParameters, soil_of
from backhoe.simulation.trial import TARGET, TICK
from backhoe.whole_body import stability

START, STOP = 0.65, 0.85
"""Strain from which the primitive slows down, and at which it stands [1]."""

BACK = -1.0
"""Fastest that it goes back, over its own speed [1]."""

HOOKED = 0.5
"""Downward share of the push from which the bucket hangs under something [1]: a lift is no help."""

ESCAPE = 1.0
"""How long it goes back then [s]; lifted as soon as nothing presses any more."""

RISE = 0.5
"""Speed of the lift while the primitive stands [m/s]."""

FORGET = 0.7
"""Time constant with which the lift sinks away when nothing presses [s]."""

WAITING = 0.1
"""Lift at which the primitive goes on at half its speed: it waits until it is down again [m]."""

HIGHEST = 1.0
"""The lift ends here [m]."""

SMOOTHING = 0.05
"""Time constant of the filter on the strain: accelerations are noisy [s]."""

UP = np.array([0.0, 0.0, 1.0, 0.0])
"""Of the reference: x, y, z and the bucket's angle."""

LATEST = 2.0
"""A dig that takes longer than this many times its duration is given up [1]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FeltDig(Record):
    """What happened; n rows, 100 a second.

    Attributes:
        time: shape (n,) [s].
        phase: time on the primitive, shape (n,) [s].
        lift: of the reference, shape (n,) [m].
        wanted: reference of stick's tip and bucket, shape (n, 4) [m, rad].
        reached: where they were, shape (n, 4) [m, rad].
        torque: of the joints, mean of ten steps, shape (n, 4) [N m].
        push: at the tip as felt, force in the base frame [N] and moment [N m], shape (n, 4).
        true: of the soil and the load's weight at the tip, force in the world, shape (n, 3) [N].
        strain: felt, shape (n,) [1].
        full: share of the steps at a torque limit, shape (n,) [1].
        volume: in the bucket, shape (n,) [m^3].
        finished: whether the primitive came to its end in `LATEST` times its duration.
        tipped: the error if the machine tipped over, or None.
    """

    time: NDArray
    phase: NDArray
    lift: NDArray
    wanted: NDArray
    reached: NDArray
    torque: NDArray
    push: NDArray
    true: NDArray
    strain: NDArray
    full: NDArray
    volume: NDArray
    finished: bool
    tipped: simulation.Tipped | None
    SHOWN = ("mission.feeling.dig", "Dig", "3D replay of the backhoe digging by feel")

    @property
    def soil(self) -> float:
        """In the bucket at the end [m^3]."""
        return float(self.volume[-1])

    @property
    def edge(self) -> NDArray:
        """Where the bucket's edge was, x, y, z in the base frame, shape (n, 3) [m]."""
        q = kinematics.inverse_kinematics(self.reached, machine=self.machine)
        return kinematics.forward_kinematics(q, "tip", machine=self.machine)[:, :3, 3]

    @property
    def saturated(self) -> float:
        """Longest time without a break in which a joint gave all that it can [s]."""
        return longest(self.full > 0.5) * TICK

    @property
    def stalled(self) -> float:
        """Longest time in which the stick's tip hung back 0.1 m or more, slower than 2 cm/s [s]."""
        behind = np.linalg.norm((self.wanted - self.reached)[:, :3], axis=1) > 0.1
        moved = np.linalg.norm(np.gradient(self.reached[:, :3], TICK, axis=0), axis=1)
        return longest(behind & (moved < 0.02)) * TICK

    def __str__(self) -> str:
        end = "" if self.finished else ", not finished"
        return (
            f"{self.soil:.2f} m^3 in {self.time[-1]:.1f} s, strain up to {self.strain.max():.2f}, "
            f"at a limit for {self.saturated:.2f} s, stalled for {self.stalled:.2f} s, "
            f"lifted by up to {self.lift.max():.2f} m{end}{', tipped over' * bool(self.tipped)}"
        )


def longest(true: NDArray) -> int:
    """Length of the longest row of True, shape (n,), as a number of samples [1]."""
    edges = np.flatnonzero(np.diff(np.r_[False, true, False]))
    return int((edges[1::2] - edges[::2]).max(initial=0))


def strain_of(q: ArrayLike, push: ArrayLike, machine: Machine = BACKHOE) -> float:
    """How near a push at the tip comes to the largest of its kind that the machine can take.

    The joints hold their own arm, g, and the push: |g - m J^T w| within their limits for the
    largest m. And the tracks stay down: with m times the push the ground still carries the machine
    inside their support polygon. The strain is 1/m: 0 without a push, 1 at a limit.

    Args:
        q: joint angles, shape (4,) [rad].
        push: force in the base frame [N] and moment raising the pitch [N m], shape (4,).
        machine: whose arm.

    Raises:
        ValueError: a wrong shape or a value that is not finite.
    """
    q = inputs.numbers(q, "q", (4,), meaning="joint angles")
    push = inputs.numbers(push, "push", (4,), meaning=contact.PUSH)
    by_push = -contact.joint_torque(q, push, machine)
    own = dynamics.gravity_torque(q, machine)
    room = machine.torque_limit - np.sign(by_push) * own
    lost = 1 - _holding(q, push, machine) / _holding(q, np.zeros(4), machine)
    return float(max((np.abs(by_push) / np.maximum(room, 1.0)).max(), lost.max()))


def _holding(q: NDArray, push: NDArray, machine: Machine) -> NDArray:
    """Moments that keep the tracks down about their four edges, shape (4,) [N m]."""
    carried = machine.mass * machine.gravity - push[2]
    if carried <= 0.0:
        return np.zeros(4)
    point = stability.zero_moment_point(q, soil=push, machine=machine)
    return carried * stability.distances(point, stability.support_polygon(machine))


class Feel:
    """The law: from what is felt to how fast the primitive goes on, and how far it is lifted.

    Attributes:
        lift: of the reference [m].
        escape: how long it will still go back from under what it hooked [s].
    """

    def __init__(self) -> None:
        self.lift = self.escape = 0.0

    def __call__(self, strain: float, hooked: bool, dt: float) -> tuple[float, float]:
        """Rate of the primitive's time [1] and lift [m] after dt [s].

        Args:
            strain: felt [1].
            hooked: whether the push holds the bucket down.
            dt: since the last call [s].
        """
        rate = min(max((STOP - strain) / (STOP - START), BACK), 1.0)
        if hooked and rate < 1.0:
            self.escape = ESCAPE
        if self.escape > 0.0:
            self.escape -= dt
            raised, rate = RISE * (rate == 1.0), BACK
        elif rate < 1.0:
            raised = RISE * (1 - max(rate, 0.0))
        else:
            raised = -self.lift / FORGET
        self.lift = min(self.lift + raised * dt, HIGHEST)
        return min(rate, 1 / (1 + self.lift / WAITING)), self.lift


def dig(
    path: ArrayLike,
    times: ArrayLike,
    *,
    feel: bool = True,
    base: str = "tracks",
    scene: Scene = LOADING,
    seed: int = 0,
    soil: str | SoilParameters = "sandy loam",
    machine: Machine = BACKHOE,
    backend: str = "auto",
    record: bool = False,
) -> FeltDig:
    """Dig along a path in the full simulation, at 1 kHz, with the controller of lesson 03.

    Args:
        path: stick's tip x, y, z in the base frame [m] and bucket joint's angle [rad], shape
            (n, 4), as a primitive's roll-out gives it.
        times: of its rows, rising, shape (n,) [s].
        feel: whether the machine gives way to what it feels.
        base: "tracks", or "fixed" for a machine that cannot tip over: what its joints alone do.
        scene, seed, soil, machine, backend: as in `simulation.open_world`.
        record: keep what the 3D replay needs.

    Raises:
        ValueError: a wrong shape, a value that is not finite, times that do not rise, a path out of
            reach, or an argument of `open_world` that is malformed.
        TypeError: likewise.
    """
    from scipy.interpolate import CubicSpline

    times = inputs.times(times, "times", least=4)
    path = inputs.numbers(path, "path", (len(times), 4), meaning=TARGET)
    way, duration = CubicSpline(times - times[0], path), float(times[-1] - times[0])
    inverse = partial(kinematics.inverse_kinematics, machine=machine)
    inverse(path)
    feel = Feel() if inputs.flag(feel, "feel") else None
    options = {
        "backend": backend,
        "scene": scene,
        "seed": seed,
        "soil": soil_of(soil),
        "base": base,
    }
    with simulation.open_world(machine, q=inverse(path[0]), **options) as world:
        return _Digger(world, way, duration, feel, record).run()


class _Digger:
    """The loop, its sensors and its log."""

    def __init__(self, world, way, duration: float, feel: Feel | None, record: bool) -> None:
        self.world, self.way, self.duration, self.feel = world, way, duration, feel
        self.controller = pid.PID(*pid.ARM_GAINS, world.machine.torque_limit)
        self.recorder = recorder_of(world) if record else None
        self.log, self.strain, self.hooked, self.q_ref = [], 0.0, False, world.q

    def run(self) -> FeltDig:
        phase = lift = 0.0
        tipped, ticks = None, 0
        while phase < self.duration and ticks < LATEST * self.duration / TICK:
            ticks += 1
            rate = 1.0
            if self.feel is not None:
                rate, lift = self.feel(self.strain, self.hooked, TICK)
            phase = min(max(phase + rate * TICK, 0.0), self.duration)
            wanted = self.way(phase) + lift * UP
            try:
                self._tick(phase, lift, wanted)
            except simulation.Tipped as error:
                tipped = error
                break
        return self._made(phase >= self.duration, tipped)

    def _tick(self, phase: float, lift: float, wanted: NDArray) -> None:
        """Ten steps towards the reference, and what was felt in them."""
        world, machine = self.world, self.world.machine
        goal = kinematics.inverse_kinematics(wanted, machine=machine, on_failure="nan")
        start, goal = self.q_ref, np.where(np.isnan(goal), self.q_ref, goal)
        self.q_ref, speed = goal, (goal - start) / TICK
        torque, full, dq_start = np.zeros(4), 0, world.dq
        for step in range(STEPS):
            q, dq = world.q, world.dq
            at = start + (step + 1) / STEPS * (goal - start)
            wanted_torque = self.controller(at, speed, q, dq, world.dt)
            world.step(wanted_torque + dynamics.gravity_torque(q, machine))
            torque += world.torque / STEPS
            full += bool((np.abs(world.torque) >= 0.999 * machine.torque_limit).any())
        q, dq = world.q, world.dq
        ddq, middle = (dq - dq_start) / TICK, (dq + dq_start) / 2
        push = felt_push(q - middle * TICK / 2, middle, ddq, torque, machine)
        now = strain_of(q, push, machine)
        self.strain += (now - self.strain) * TICK / SMOOTHING
        self.hooked = push[2] < -HOOKED * np.linalg.norm(push[:3])
        true = world.soil_force - [0, 0, world.ground.payload * machine.gravity]
        reached = kinematics.pose(q, machine=machine)
        row = world.time, phase, lift, wanted, reached, torque, push, true, self.strain
        self.log.append((*row, full / STEPS, world.ground.bucket_volume))
        if self.recorder is not None:
            self.recorder.capture()

    def _made(self, finished: bool, tipped: simulation.Tipped | None) -> FeltDig:
        names = "time phase lift wanted reached torque push true strain full volume".split()
        columns = map(np.array, zip(*self.log, strict=True))
        return FeltDig(
            swapped=(),
            machine=self.world.machine,
            backend=self.world.backend,
            recorder=self.recorder,
            finished=finished,
            tipped=tipped,
            **dict(zip(names, columns, strict=True)),
        )


def felt_push(
    q: ArrayLike, dq: ArrayLike, ddq: ArrayLike, torque: ArrayLike, machine: Machine = BACKHOE
) -> NDArray:
    """The push at the bucket's tip that the joints' torques tell of.

    What the empty arm's motion and friction need, less what the actuators give (lesson 02). A load
    in the bucket is felt as part of the push, as if it hung at the tip.

    Args:
        q, dq, ddq: motion of the joints, shape (..., 4) [rad, rad/s, rad/s^2].
        torque: of the actuators, shape (..., 4) [N m].
        machine: whose arm.

    Returns:
        Force in the base frame [N] and moment that raises the pitch [N m], shape (..., 4).

    Raises:
        ValueError: as for `contact.push_from`.
    """
    torque = inputs.numbers(torque, "torque", (..., 4), meaning="torques of the joints [N m]")
    friction = dynamics.friction_torque(dq, machine, COULOMB_SMOOTHING)
    needed = dynamics.inverse_dynamics(q, dq, ddq, machine=machine) + friction
    return contact.push_from(q, needed - torque, machine)
