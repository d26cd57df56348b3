"""A batch of closed loops, checked once and put side by side, one row for each run."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import KW_ONLY, dataclass, field, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics
from backhoe.arm.kinematics import joint_vector
from backhoe.arm.movement import Movement
from backhoe.arm.pid import Gains
from backhoe.basics.inputs import alike, choice, indices, instance, not_negative, numbers, whole
from backhoe.machine import BACKHOE, JOINTS, Machine, variants

LAWS = ("pid", "pid+gravity", "computed_torque")
_RATES = ("difference", "measured")

COULOMB_SMOOTHING = 0.01
"""Speed below which Coulomb friction passes smoothly through zero [rad/s], as in `simulation`."""

_MOBILITY_EVERY = 50


@dataclass(frozen=True, eq=False)
class Task:
    """What `simulate` takes, in the same words, for n runs.

    Checked, `gains` have shape (n, 4) each, `payload` (n,), `q0` (n, 4), `torque_limit` (4,), and
    `record` holds indices. `integral` (n, 4) [rad s] is the sum of the error at the start.
    """

    gains: Gains
    movement: Movement
    _: KW_ONLY
    machine: Machine = BACKHOE
    model: Machine | None = None
    law: str = "pid"
    friction: bool = True
    torque_limit: ArrayLike | None = None
    payload: ArrayLike = 0.0
    q0: ArrayLike | None = None
    settled: bool = False
    state_every: int = 1
    rate: str = "measured"
    filter_time: float = 0.0
    record: Iterable[int] | str = ()
    record_every: int = 1
    integral: NDArray = field(init=False)

    def __post_init__(self) -> None:
        movement = instance(self.movement, "movement", Movement)
        choice(self.law, "law", LAWS)
        choice(self.rate, "rate", _RATES)
        gains = _gains(self.gains)
        count = len(gains.kp)
        self._keep(
            gains=gains,
            model=self.machine if self.model is None else self.model,
            torque_limit=_torque_limit(self.torque_limit),
            payload=_payload(self.payload, count),
            q0=_start(movement.q[0] if self.q0 is None else self.q0, count),
            state_every=whole(self.state_every, "state_every", least=1),
            filter_time=not_negative(self.filter_time, "filter_time", "s"),
            record=_record(self.record, count),
            record_every=whole(self.record_every, "record_every", least=1),
        )
        if self.filter_time > 0 and self.rate == "measured":
            raise ValueError(
                'filter_time goes with rate="difference": measured speeds need no filter'
            )
        self._keep(integral=_settled_integral(self) if self.settled else np.zeros((count, 4)))

    def __len__(self) -> int:
        return len(self.payload)

    def _keep(self, **checked: object) -> None:
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    def part(self, first: int, last: int) -> dict[str, object]:
        """The options, but for the movement, of the runs from `first` up to, not with, `last`."""
        options = {item.name: getattr(self, item.name) for item in fields(self) if item.init}
        del options["movement"]
        return options | {
            "gains": Gains(*(gain[first:last] for gain in self.gains)),
            "payload": self.payload[first:last],
            "q0": self.q0[first:last],
            "record": [index - first for index in self.record if first <= index < last],
        }

    @property
    def settling_rates(self) -> NDArray:
        """Rate at which smoothed Coulomb friction settles a slow speed, shape (m, 4) [1/s].

        It is the friction over the smoothing speed, times the joint's mobility at the reference.
        """
        M = dynamics.mass_matrix(self.movement.q[::_MOBILITY_EVERY], self.machine)
        mobility = np.diagonal(np.linalg.inv(M), axis1=-2, axis2=-1)
        slope = self.friction * self.machine.coulomb / COULOMB_SMOOTHING
        return np.repeat(slope * mobility, _MOBILITY_EVERY, axis=0)[: len(self.movement)]


def _gains(gains: Gains) -> Gains:
    """Shape (n, 4) each."""
    instance(gains, "gains", Gains, "give pid.Gains(kp=..., ki=..., kd=...)")
    rows = {
        name: numbers(np.atleast_2d(numbers(gain, name)), name, ("n", 4), meaning="one row a run")
        for name, gain in gains._asdict().items()
    }
    alike(**rows)
    for name, gain in rows.items():
        if (gain < 0).any():
            raise ValueError(f"{name} must not be negative, got {gain.min():g} in it")
    return Gains(**rows)


def _payload(payload: ArrayLike, count: int) -> NDArray:
    payload = numbers(payload, "payload")
    if payload.shape not in ((), (count,)):
        raise ValueError(
            f"payload must be one mass or one for each of {count} runs, got shape {payload.shape}"
        )
    if (payload < 0).any():
        raise ValueError(f"payload must not be negative, got {payload.min():g} kg in it")
    return np.full(count, payload)


def _start(q0: ArrayLike, count: int) -> NDArray:
    q0 = joint_vector(q0, "q0")
    if q0.shape not in ((4,), (count, 4)):
        raise ValueError(f"q0 must have shape (4,) or ({count}, 4), got {q0.shape}")
    return np.broadcast_to(q0, (count, 4))


def _torque_limit(limit: ArrayLike | None) -> NDArray:
    if limit is None:
        return np.full(4, np.inf)
    limit = numbers(limit, "torque_limit", (4,), meaning="one torque a joint", finite=False)
    if not (limit > 0).all():
        raise ValueError(f"torque_limit must be positive, got {limit} N m")
    return limit


def _record(record: Iterable[int] | str, count: int) -> tuple[int, ...]:
    return tuple(range(count)) if record == "all" else indices(record, "record", count)


def _settled_integral(task: Task) -> NDArray:
    """The sum of the error with which the law holds the arm still at q0, shape (n, 4) [rad s]."""
    lever = dynamics.gravity_torque(task.q0, variants.loaded(1.0, task.machine))
    empty = dynamics.gravity_torque(task.q0, task.machine)
    wanted = empty + task.payload[:, None] * (lever - empty)
    if task.law != "pid":
        wanted = wanted - dynamics.gravity_torque(task.q0, task.model)
    if task.law == "computed_torque":
        M = dynamics.mass_matrix(task.q0, task.model)
        wanted = np.linalg.solve(M, wanted[..., None])[..., 0]
    ki = task.gains.ki
    helpless = (ki == 0) & (wanted != 0)
    if helpless.any():
        run, joint = np.argwhere(helpless)[0]
        raise ValueError(
            f"settled needs ki above 0 where gravity pulls: in run {run} the {JOINTS[joint]} has "
            f"ki = 0 and must give {wanted[run, joint]:.4g}"
        )
    return np.divide(wanted, ki, out=np.zeros_like(wanted), where=ki > 0)
