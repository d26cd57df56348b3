"""The arguments of a batch, checked once and put side by side, one row for each run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics
from backhoe.arm.kinematics import joint_vector
from backhoe.arm.movement import Movement
from backhoe.basics.inputs import real_array
from backhoe.machine import BACKHOE, JOINTS, Machine, variants

LAWS = ("pid", "pid+gravity", "computed_torque")
RATES = ("difference", "measured")


class Task(NamedTuple):
    """A batch, checked: what each run has of its own, and what all share."""

    gains: NDArray
    payload: NDArray
    start: NDArray
    movement: Movement
    machine: Machine
    model: Machine
    law: str
    friction: bool
    torque_limit: NDArray
    settled: bool
    state_every: int
    rate: str
    filter_time: float
    record: tuple[int, ...]
    record_every: int

    def part(self, first: int, last: int) -> Task:
        """The runs from `first` up to, not including, `last`, counted from 0 again."""
        return self._replace(
            gains=self.gains[first:last],
            payload=self.payload[first:last],
            start=self.start[first:last],
            record=tuple(index - first for index in self.record if first <= index < last),
        )


def prepared(
    gains: Sequence[ArrayLike],
    movement: Movement,
    *,
    machine: Machine = BACKHOE,
    model: Machine | None = None,
    law: str = "pid",
    friction: bool = True,
    torque_limit: ArrayLike | None = None,
    payload: ArrayLike = 0.0,
    q0: ArrayLike | None = None,
    settled: bool = False,
    state_every: int = 1,
    rate: str = "measured",
    filter_time: float = 0.0,
    record: Iterable[int] | str = (),
    record_every: int = 1,
) -> Task:
    """The arguments of `simulate`, checked and each run's own put side by side."""
    if not isinstance(movement, Movement):
        raise TypeError(f"movement must be a movement, got {type(movement).__name__}")
    model = machine if model is None else model
    _one_of("law", law, LAWS)
    _one_of("rate", rate, RATES)
    filter_time = _time("filter_time", filter_time)
    if filter_time > 0 and rate == "measured":
        raise ValueError('filter_time goes with rate="difference": measured speeds need no filter')
    gains = _gains(gains)
    count = len(gains)
    payload = _payload(payload, count)
    start = np.zeros((count, 3, 4))
    start[:, 0] = _start_angles(movement.q[0] if q0 is None else q0, count)
    start[:, 1] = movement.dq[0]
    if settled:
        start[:, 2] = _settled_integral(gains, start[:, 0], payload, machine, model, law)
    return Task(
        gains=gains,
        payload=payload,
        start=start,
        movement=movement,
        machine=machine,
        model=model,
        law=law,
        friction=bool(friction),
        torque_limit=_torque_limit(torque_limit),
        settled=settled,
        state_every=_count("state_every", state_every),
        rate=rate,
        filter_time=filter_time,
        record=_record(record, count),
        record_every=_count("record_every", record_every),
    )


def _gains(gains: Sequence[ArrayLike]) -> NDArray:
    """kp, ki, kd of each run, shape (n, 3, 4)."""
    if not (isinstance(gains, Sequence | np.ndarray) and len(gains) == 3):
        raise ValueError("gains must be kp, ki and kd, of shape (4,) or (n, 4) each")
    parts = [
        real_array(gain, f"{name} must be numbers")
        for name, gain in zip(("kp", "ki", "kd"), gains, strict=True)
    ]
    shapes = [part.shape for part in parts]
    if len(set(shapes)) > 1 or shapes[0][-1:] != (4,) or len(shapes[0]) > 2 or 0 in shapes[0]:
        raise ValueError(
            "kp, ki and kd must all have shape (4,), for one run, or (n, 4), one row for each run, "
            f"got {', '.join(map(str, shapes))}"
        )
    for name, part in zip(("kp", "ki", "kd"), parts, strict=True):
        if not (np.isfinite(part).all() and (part >= 0).all()):
            bad = part[~(np.isfinite(part) & (part >= 0))][0]
            raise ValueError(f"{name} must be finite and not negative, got {bad:g} in it")
    return np.stack([part.reshape(-1, 4) for part in parts], axis=1)


def _payload(payload: ArrayLike, count: int) -> NDArray:
    payload = real_array(payload, "payload must be a mass in kg")
    if payload.shape not in ((), (count,)):
        raise ValueError(
            f"payload must be one mass or one for each of {count} runs, got shape {payload.shape}"
        )
    if not (np.isfinite(payload).all() and (payload >= 0).all()):
        raise ValueError(f"payload must be finite and not negative, got {payload} kg")
    return np.full(count, payload)


def _start_angles(q0: ArrayLike, count: int) -> NDArray:
    q0 = joint_vector(q0, "q0")
    if q0.shape not in ((4,), (count, 4)):
        raise ValueError(f"q0 must have shape (4,) or ({count}, 4), got {q0.shape}")
    return q0


def _torque_limit(limit: ArrayLike | None) -> NDArray:
    if limit is None:
        return np.full(4, np.inf)
    limit = real_array(limit, "torque_limit must be numbers in N m")
    if limit.shape != (4,) or not (limit > 0).all():
        raise ValueError(f"torque_limit must be positive, one for each of 4 joints, got {limit}")
    return limit


def _settled_integral(
    gains: NDArray,
    q: NDArray,
    payload: NDArray,
    machine: Machine,
    model: Machine,
    law: str,
) -> NDArray:
    """The sum of the error with which the law holds the arm still at q, shape (n, 4) [rad s]."""
    lever = dynamics.gravity_torque(q, variants.loaded(1.0, machine))
    empty = dynamics.gravity_torque(q, machine)
    wanted = empty + payload[:, None] * (lever - empty)
    if law != "pid":
        wanted = wanted - dynamics.gravity_torque(q, model)
    if law == "computed_torque":
        wanted = np.linalg.solve(dynamics.mass_matrix(q, model), wanted[..., None])[..., 0]
    ki = gains[:, 1]
    helpless = (ki == 0) & (wanted != 0)
    if helpless.any():
        run, joint = np.argwhere(helpless)[0]
        raise ValueError(
            f"settled needs ki above 0 where gravity pulls: in run {run} the {JOINTS[joint]} has "
            f"ki = 0 and must give {wanted[run, joint]:.4g}"
        )
    return np.divide(wanted, ki, out=np.zeros_like(wanted), where=ki > 0)


def _record(record: Iterable[int] | str, count: int) -> tuple[int, ...]:
    if isinstance(record, str):
        if record != "all":
            raise ValueError(f'record must be indices of runs or "all", got {record!r}')
        return tuple(range(count))
    indices = tuple(record)
    for index in indices:
        if isinstance(index, bool) or not isinstance(index, int | np.integer):
            raise ValueError(f"record must hold whole numbers, got {index!r}")
        if not 0 <= index < count:
            raise ValueError(f"record must name runs from 0 to {count - 1}, got {index}")
    return tuple(map(int, indices))


def _count(name: str, value: object) -> int:
    whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not whole or value < 1:
        raise ValueError(f"{name} must be a whole number of samples, 1 or more, got {value!r}")
    return int(value)


def _time(name: str, value: object) -> float:
    number = real_array(value, f"{name} must be a time in s")
    if number.shape != () or not (np.isfinite(number) and number >= 0):
        raise ValueError(f"{name} must be a time in s, 0 or more, got {value!r}")
    return float(number)


def _one_of(name: str, value: object, words: tuple[str, ...]) -> None:
    if not isinstance(value, str) or value not in words:
        listed = ", ".join(f'"{word}"' for word in words)
        raise ValueError(f"{name} must be one of {listed}, got {value!r}")
