"""The tick that all backends share: check, push, integrate, dig.

A backend derives from `Loop` and brings the integration: `_integrate`, `_place` and, when the load
changes, `_carry`. Forces come from `forces`, the soil's answer at 100 Hz from `soil.Ground`.
"""

from __future__ import annotations

import weakref
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, instance, numbers, real_numbers, whole
from backhoe.machine import BACKHOE, Machine
from backhoe.simulation import engine, forces, standing
from backhoe.simulation.clock import STEP, TICKS_PER_DIG
from backhoe.simulation.scene import LOADING, Scene, untouched_ground
from backhoe.simulation.soil import SANDY_LOAM, SoilParameters, soil_of
from backhoe.whole_body.stability import EDGES

BASES = ("tracks", "fixed")

STANDING = (0.0, 0.0)
"""Belt speeds of a machine that stands [m/s]."""

_STILL = np.zeros(2)
_SHAPES = (4,), (2,)
_JOINTS = "joints (swing, boom, stick, bucket)"

RUNAWAY = 50.0
"""A rate far beyond what any machine of this kind survives [rad/s or m/s]."""

REST = np.radians([-90.0, 30.0, -30.0, 0.0])
"""Joint angles at the start [rad]: arm forward, folded, clear of the ground."""


@dataclass(frozen=True)
class Snapshot:
    """State of a simulation: pass it to `restore` of the simulation that made it."""

    owner: object
    ticks: int
    memory: NDArray
    balance: NDArray
    payload: float
    in_soil: bool
    ground: object
    kept: object


class Loop:
    """A simulated machine without the integration of its motion; see `protocol.World`.

    Args:
        machine: its numbers.
        scene: what stands around it.
        seed: of the bumps on the heaps.
        q: joint angles at the start, shape (4,) [rad]; default `REST`.
        soil: True for a moist sandy loam, the name of another soil, or its `SoilParameters`; False
            for ground that cannot be dug: `ground` is None.
        base: "tracks" for a machine on its tracks' friction, "fixed" for a base that cannot move.
        friction: whether the joints have the machine's viscous and Coulomb friction.

    Raises:
        TypeError: machine or scene is something else.
        ValueError: q is not 4 finite angles, seed is not a whole number of 0 or more, no soil has
            that name, or base is neither of the two.
    """

    backend = "none"
    dt = STEP

    def __init__(
        self,
        machine: Machine = BACKHOE,
        scene: Scene = LOADING,
        seed: int = 0,
        q: ArrayLike | None = None,
        soil: bool | str | SoilParameters = True,
        base: str = "tracks",
        friction: bool = True,
    ) -> None:
        self.machine = instance(machine, "machine", Machine)
        self.scene = instance(scene, "scene", Scene)
        self.seed, self.base = whole(seed, "seed", least=0), choice(base, "base", BASES)
        self._closed = False
        self._token = object()
        self._start = numbers(REST if q is None else q, "q", (4,), meaning=_JOINTS).copy()
        wanted = SANDY_LOAM if soil is True else soil
        self._soil = None if wanted is False else soil_of(wanted)
        self._numbers = forces.numbers_of(machine, friction)
        self._plain = tuple(self._numbers)
        self._memory = forces.memory_of(self._numbers)
        self._state = forces.state_in(self._memory)
        self._motion, self._masses = self._memory[:14], standing.masses_of(machine)
        self._balance_memory = np.zeros(standing.MEMORY)
        self._balance = standing.balance_in(self._balance_memory)
        self._open()
        self.reset()

    @property
    def time(self) -> float:
        return self._ticks * self.dt

    @property
    def q(self) -> NDArray:
        return self._state.q[3:].copy()

    @property
    def dq(self) -> NDArray:
        return self._state.dq[3:].copy()

    @property
    def pose(self) -> NDArray:
        return self._state.q[:3].copy()

    @property
    def twist(self) -> NDArray:
        return self._state.dq[:3].copy()

    @property
    def belts(self) -> NDArray:
        return self._state.belts.copy()

    @property
    def traction(self) -> NDArray:
        return self._state.traction.copy()

    @property
    def torque(self) -> NDArray:
        return self._state.torque.copy()

    @property
    def soil_force(self) -> NDArray:
        return self._state.soil[:3].copy()

    @property
    def zero_moment_point(self) -> NDArray:
        return self._balance.point[:2].copy()

    @property
    def margin(self) -> float:
        return float(self._balance.margin[0])

    @property
    def edge(self) -> str:
        return EDGES[int(self._balance.margin[1])]

    @property
    def least_margin(self) -> standing.Least:
        return standing.least_of(self._balance, self.dt)

    def step(
        self,
        torque: ArrayLike,
        belts: ArrayLike = STANDING,
        *,
        traction: ArrayLike | None = None,
    ) -> None:
        """Advance by one step of 1 ms.

        Torques beyond the machine's limits are cut as its actuators would; `torque` says what was
        applied. Belts follow their command within the machine's speed and acceleration; or, given
        `traction`, they run as the forces on them make them run, and the property `traction` says
        what the drives gave. At the ends of the joints' range elastic stops push back.

        Args:
            torque: wanted joint torques, shape (4,) [N m].
            belts: wanted speed of the left and right belt, shape (2,) [m/s].
            traction: wanted driving force of the left and right track, shape (2,) [N]; instead of
                `belts`.

        Raises:
            ValueError: a wrong shape, a value that is not finite, belts and traction at once, or
                traction with a fixed base.
            RuntimeError: the simulation is closed, or the machine ran away.
            Tipped: the machine tips over (a RuntimeError).
        """
        self._check_open()
        driven = traction is not None
        if driven and belts is not STANDING:
            raise ValueError("give belts (speeds) or traction (forces), not both")
        if driven and self.base == "fixed":
            raise ValueError("a fixed base cannot be driven: open the world with tracks")
        name, command = ("traction", traction) if driven else ("belts", belts)
        torque = real_numbers(torque, "torque")
        command = _STILL if command is STANDING else real_numbers(command, name)
        shapes = torque.shape, command.shape
        if shapes != _SHAPES or not engine.push(
            self._plain, self._memory, torque, command, driven, self.dt
        ):
            numbers(torque, "torque", (4,), meaning=f"{_JOINTS} [N m]")
            numbers(command, name, (2,), meaning=f"left and right [{'N' if driven else 'm/s'}]")
        self._integrate()
        self._ticks += 1
        self._stand()
        if self._ticks % TICKS_PER_DIG == 0 and not np.abs(self._state.dq).max() < RUNAWAY:
            self._run_away()
        if self.ground is not None:
            self._dig()

    def reset(self, q: ArrayLike | None = None, pose: ArrayLike | None = None) -> None:
        """Start again at time 0, at rest and unloaded, on untouched ground.

        Args:
            q: joint angles, shape (4,) [rad]; default where the simulation was opened.
            pose: x, y, yaw of the vehicle, shape (3,) [m, m, rad]; default the origin.

        Raises:
            ValueError: a wrong shape or a value that is not finite; a pose with a fixed base.
            RuntimeError: the simulation is closed.
        """
        self._check_open()
        q = numbers(self._start if q is None else q, "q", (4,), meaning=_JOINTS)
        pose = numbers(np.zeros(3) if pose is None else pose, "pose", (3,), meaning="x, y, yaw")
        if self.base == "fixed" and pose.any():
            raise ValueError("a fixed base stays at x = y = yaw = 0: open the world with tracks")
        self._ticks, self._in_soil = 0, False
        self._memory[:] = self._balance_memory[:] = 0.0
        self._balance.least[0] = np.inf
        self.ground = (
            None
            if self._soil is None
            else untouched_ground(self.scene, self.machine, self.seed, STEP, self._soil)
        )
        self._load(0.0)
        self._state.q[:] = *pose, *q
        self._place()
        self._balance.before[:] = self._motion
        self._stand()

    def snapshot(self) -> Snapshot:
        """Everything that the future depends on; pass it to `restore`."""
        self._check_open()
        made = Snapshot(
            self._token,
            self._ticks,
            self._memory.copy(),
            self._balance_memory.copy(),
            float(self._numbers.load[1]),
            self._in_soil,
            None if self.ground is None else self.ground.snapshot(),
            self._keep(),
        )
        weakref.finalize(made, self._forget, made.kept)
        return made

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot; what follows then repeats bit for bit.

        Raises:
            ValueError: the snapshot is of another simulation.
            RuntimeError: the simulation is closed.
        """
        self._check_open()
        if not isinstance(snapshot, Snapshot) or snapshot.owner is not self._token:
            raise ValueError("restore needs a snapshot of this very simulation")
        self._ticks = snapshot.ticks
        self._memory[:] = snapshot.memory
        self._balance_memory[:] = snapshot.balance
        if self.ground is not None:
            self.ground.restore(snapshot.ground)
        self._in_soil = snapshot.in_soil
        self._load(snapshot.payload)
        self._bring_back(snapshot.kept)

    def close(self) -> None:
        """Release what the simulation holds; a second call does nothing."""
        if not self._closed:
            self._closed = True
            self._shut()

    def __enter__(self) -> Loop:
        self._check_open()
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def render(self, *view: object, **options: object) -> NDArray:
        """Only the PyBullet backend has cameras.

        Raises:
            RuntimeError: always, here.
        """
        raise RuntimeError(
            f"the {self.backend} backend has no cameras: install PyBullet and open the world with "
            'backend="pybullet", or watch a replay'
        )

    # What a backend brings.

    def _integrate(self) -> None:
        """Advance coordinates and rates in self._state under its forces."""
        raise NotImplementedError

    def _place(self) -> None:
        """Put the machine at the coordinates in self._state, at rest."""

    def _carry(self, payload: float) -> None:
        """Take `payload` [kg] along at the bucket's centre of mass."""

    def _open(self) -> None:
        """Prepare the backend."""

    def _shut(self) -> None:
        """Release the backend."""

    def _keep(self) -> object:
        """What there is to remember beyond the memory."""

    def _bring_back(self, state: object) -> None:
        """Go back to what `_keep` returned."""

    def _forget(self, state: object) -> None:
        """Release what `_keep` returned: its snapshot is gone."""

    def _dig(self) -> None:
        """Let the soil move on at 100 Hz and, in it, feel it at 1 kHz."""
        visit = self._ticks % TICKS_PER_DIG == 0
        if not (visit or self._in_soil):
            return
        ground = self.ground
        T_world_tip, velocity = engine.tip_motion(
            self._numbers.reach, self._state.q, self._state.dq
        )
        _, _, _, _, *turning = self._state.dq.tolist()
        pitch_rate = sum(turning)
        if visit:
            if not velocity @ velocity < RUNAWAY**2:
                self._run_away()
            force = ground.advance(T_world_tip, velocity, TICKS_PER_DIG * self.dt, pitch_rate)
            self._load(ground.payload)
            self._in_soil = ground.touches
        else:
            force = ground.force(T_world_tip[:3, 3], velocity, pitch_rate, T_world_tip)
        self._state.soil[:3] = force
        self._state.soil[3] = ground.moment

    def _stand(self) -> None:
        """Balance the last step; end the run of a machine that has tipped."""
        edge = engine.stand(
            self._masses,
            self._motion,
            self._state.soil,
            self._balance_memory,
            self._ticks,
            self.dt,
        )
        if edge >= 0 and self.base == "tracks":
            load, least = float(self._numbers.load[1]), self._balance.least
            raise standing.verdict(edge, self.time, self.q, load, least, self.machine)

    def _load(self, payload: float) -> None:
        if payload != self._numbers.load[1] or self._ticks == 0:
            self._numbers.load[1] = payload
            self._masses[-1] = self.machine.bucket.mass + payload
            self._carry(payload)

    def _run_away(self) -> None:
        raise RuntimeError(
            f"the machine ran away at t = {self.time:.3f} s with rates {self._state.dq.round(1)}: "
            "the torques drive it apart (in a controller: a wrong sign, or a damping gain above "
            "twice the joint's inertia over the step); call reset() before going on"
        )

    def _check_open(self) -> None:
        if self._closed:
            raise RuntimeError(
                "this simulation is closed: open a new one with simulation.open_world()"
            )
