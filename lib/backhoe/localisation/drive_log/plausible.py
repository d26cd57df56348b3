"""Whether the numbers of a log can be in the units that its header names.

Three tests. A column may not change faster than anything on wheels does (`LIMITS`), measured over a
second so that noise does not count. Columns that say the same thing must not differ by the factors
that unit mistakes make: heading against gyroscope, both against the wheels, the way against the
wheels. And wheels do not jump: a counter that was reset does.

psi is a heading that counts turns; yaw is what an IMU or a compass shows and may be wrapped.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import choice

LIMITS: Mapping[str, float] = {
    "t": 2.0,
    **dict.fromkeys(("left", "right", "left_rate", "right_rate"), 60.0),
    **dict.fromkeys(("psi", "yaw", "roll", "pitch", "gyro", "omega"), 10.0),
    **dict.fromkeys(("x", "y", "z", "v"), 30.0),
    **dict.fromkeys(("ax", "ay", "az"), 160.0),
}
"""Largest believable period [s] for t; rate of change [1/s of the unit] for angles and positions;
magnitude for speeds and accelerations. What machines and robots do not exceed: 30 m/s, 10 rad/s,
wheels 60 rad/s."""

_INSTEAD = {
    "s": "milliseconds",
    "rad": "degrees",
    "rad/s": "degrees per second",
    "m": "millimetres",
    "m/s": "millimetres per second",
    "m/s^2": "thousandths of g",
}
_CHANGES = ("left", "right", "psi", "yaw", "roll", "pitch", "x", "y", "z")
_TURN_PER_ROLL = (0.01, 5.0)
_WAY_PER_ROLL = (0.012, 3.0)
_DEGREES = (25.0, 130.0)
_LEAST_ROLL = 0.1
"""Turn of the wheels in a second below which nothing is concluded from it [rad]."""

Where = Callable[[int, str], str]


def check(
    columns: Mapping[str, NDArray],
    units: Mapping[str, str],
    where: Where,
    file: str,
    limits: Mapping[str, float | None],
) -> None:
    """Refuse a log that contradicts its units.

    Args:
        columns: values by name, t among them, each (n,).
        units: their units, converted.
        where: text that names a row and a column.
        file: name of the file, for what concerns whole columns.
        limits: replaces entries of `LIMITS`; None as a value believes everything.

    Raises:
        ValueError: what looks wrong, with the row and the column.
    """
    for name in limits:
        choice(name, "a column with a limit", LIMITS)
    limits = {**LIMITS, **limits}
    time = columns["t"]
    _check_period(time, limits["t"], where)
    for name, values in columns.items():
        if name in ("left", "right"):
            _check_jumps(name, values, units[name], time, limits[name], where)
        if name == "psi":
            _check_wrapping(values, where)
        if name in LIMITS and name != "t" and units[name] in _INSTEAD:
            _check_rate(name, values, units[name], time, limits[name], where)
    _check_gravity(columns, limits, file)
    _check_agreement(columns, units, limits, file)


def _check_period(time: NDArray, limit: float | None, where: Where) -> None:
    period = float(np.median(np.diff(time)))
    if limit is not None and period > limit:
        raise ValueError(
            f"{where(1, 't')}: a period of {period:.4g} s: are the times in milliseconds? Write "
            "t [ms] in the header, or allow it with limits={'t': None}"
        )


def _check_jumps(
    name: str, values: NDArray, unit: str, time: NDArray, limit: float | None, where: Where
) -> None:
    if limit is None:
        return
    steps = np.diff(values)
    usual = np.median(np.abs(steps[steps != 0])) if steps.any() else 0.0
    allowed = 20 * usual + (10 if unit == "ticks" else limit * np.diff(time))
    for k in np.flatnonzero(np.abs(steps) > allowed):
        old, new = values[k], values[k + 1]
        if unit == "ticks" and _overflows(steps[k], values, usual):
            continue
        if min(abs(new), abs(new - values[0])) <= 20 * usual and abs(new) < abs(old):
            raise ValueError(
                f"{where(k + 1, name)}: falls from {old:.8g} to {new:.8g} {unit}: was the counter "
                "reset? Split the log there"
            )
        raise ValueError(
            f"{where(k + 1, name)}: jumps from {old:.8g} to {new:.8g} {unit} in "
            f"{time[k + 1] - time[k]:.4g} s: a lost reading, a reset, or another unit than {unit}?"
        )


def _overflows(step: float, values: NDArray, usual: float) -> bool:
    """Whether a step of ticks is one round of a counter of 8 to 32 bits, give or take a usual one.

    Such a counter has shown readings up to its top, and none above.
    """
    rounds, near = 2.0 ** np.arange(8, 33), 5 * usual + 10
    turned = np.abs(np.abs(step) - rounds) <= near
    below = np.array([rounds, rounds / 2]) - values.max()
    return bool((turned & ((below > 0) & (below <= near)).any(axis=0)).any())


def _check_wrapping(psi: NDArray, where: Where) -> None:
    steps = np.abs(np.diff(psi))
    for turn, unit in ((2 * np.pi, "rad"), (360.0, "degrees")):
        wraps = np.flatnonzero(np.abs(steps - turn) < turn / 4)
        if len(wraps) and steps.max() < 1.3 * turn:
            k = int(wraps[0])
            instead = "" if unit == "rad" else "; it looks like degrees: write psi [deg]"
            raise ValueError(
                f"{where(k + 1, 'psi')}: jumps from {psi[k]:.4f} to {psi[k + 1]:.4f}, a whole turn:"
                f" psi was wrapped; read it with unwrap=True{instead}"
            )


def _check_rate(
    name: str, values: NDArray, unit: str, time: NDArray, limit: float | None, where: Where
) -> None:
    if limit is None:
        return
    if name in _CHANGES:
        values = np.unwrap(values) if name == "yaw" else values
        later = _a_second_later(time)
        start = np.arange(len(later))
        rates = np.abs(values[later] - values[start]) / (time[later] - time[start])
        of, per = "changes by", f"{unit} in a second"
    else:
        rates, later = np.abs(values), np.arange(len(values))
        of, per = "is", unit
    k = int(rates.argmax())
    if rates[k] > limit:
        instead = _INSTEAD[unit]
        raise ValueError(
            f"{where(int(later[k]), name)}: {of} {rates[k]:.4g} {per}, above {limit:g}: is it in "
            f"{instead}? Write the unit that it has in the header, or allow it with "
            f"limits={{'{name}': ...}}"
        )


def _check_gravity(
    columns: Mapping[str, NDArray], limits: Mapping[str, float | None], file: str
) -> None:
    names = ("ax", "ay", "az")
    if not all(name in columns and limits[name] is not None for name in names):
        return
    size = float(np.median(np.sqrt(sum(columns[name] ** 2 for name in names))))
    if 0.8 < size < 1.2:
        raise ValueError(
            f"{file}, columns ax, ay, az: their size is {size:.3g} m/s^2 where gravity makes 9.8: "
            "are they in g? Write ax [g] in the header"
        )


def _check_agreement(
    columns: Mapping[str, NDArray],
    units: Mapping[str, str],
    limits: Mapping[str, float | None],
    file: str,
) -> None:
    later = _a_second_later(columns["t"])
    start = np.arange(len(later))

    def change(values: NDArray) -> NDArray:
        return values[later] - values[start]

    turns = {name: change(values) for name, values in _headings(columns, limits).items()}
    for heading in ("psi", "yaw"):
        if heading in turns and "gyro" in turns and np.ptp(turns[heading]) > 0.01:
            _compare_turns(heading, turns[heading], turns["gyro"], file)
    rolled = all(
        units.get(side) == "rad" and limits[side] is not None for side in ("left", "right")
    )
    if not rolled:
        return
    left, right = change(columns["left"]), change(columns["right"])
    for name, turn in turns.items():
        _compare_with_wheels(name, turn, right - left, file)
    if all(name in columns and limits[name] is not None for name in ("x", "y")):
        way = np.hypot(change(columns["x"]), change(columns["y"]))
        _compare_way(way, (left + right) / 2, file)


def _headings(
    columns: Mapping[str, NDArray], limits: Mapping[str, float | None]
) -> dict[str, NDArray]:
    """All that the log says of the heading, unwrapped, up to an offset."""
    said = {name: columns[name] for name in ("psi", "yaw", "gyro") if name in columns}
    said = {name: values for name, values in said.items() if limits[name] is not None}
    if "yaw" in said:
        said["yaw"] = np.unwrap(said["yaw"])
    if "gyro" in said:
        rate, steps = said["gyro"], np.diff(columns["t"])
        said["gyro"] = np.r_[0.0, np.cumsum((rate[1:] + rate[:-1]) / 2 * steps)]
    return said


def _compare_turns(heading: str, turned: NDArray, gyro: NDArray, file: str) -> None:
    pairs = ((heading, turned, "gyro", gyro), ("gyro", gyro, heading, turned))
    for name, one, other, two in pairs:
        ratio = abs(float(one @ two / (two @ two))) if two.any() else 0.0
        if _DEGREES[0] < ratio < _DEGREES[1]:
            raise ValueError(
                f"{file}, column {name}: turns {ratio:.3g} times as far as {other} says: is {name} "
                "in degrees? Write its unit in the header"
            )


def _compare_with_wheels(name: str, turn: NDArray, roll: NDArray, file: str) -> None:
    if np.abs(roll).max() < _LEAST_ROLL:
        return
    ratio = abs(float(turn @ roll / (roll @ roll)))
    unsure = np.abs(turn).max() < 0.1
    if ratio > _TURN_PER_ROLL[1] or (ratio < _TURN_PER_ROLL[0] and not unsure):
        wrong = name if ratio > 1 else "left, right"
        raise ValueError(
            f"{file}, columns {name}, left, right: a turn of {ratio:.3g} rad for each rad that the "
            f"wheels differ; a vehicle has between {_TURN_PER_ROLL[0]:g} and {_TURN_PER_ROLL[1]:g}:"
            f" is {wrong} in degrees? Write its unit in the header"
        )


def _compare_way(way: NDArray, roll: NDArray, file: str) -> None:
    if np.abs(roll).max() < _LEAST_ROLL:
        return
    radius = float(way @ np.abs(roll) / (roll @ roll))
    low, high = _WAY_PER_ROLL
    if radius > high or (radius < low and way.max() > 0.01):
        wrong = "left, right in degrees"
        if radius > high:
            wrong = f"x, y in {'millimetres' if radius > 100 else 'centimetres'}"
        raise ValueError(
            f"{file}, columns x, y, left, right: a way of {radius:.3g} m for each rad of the wheels"
            f", which would be their radius: are {wrong}? Write the unit in the header"
        )


def _a_second_later(time: NDArray) -> NDArray:
    """For the rows that have one, the first row at least a second later; the last one for a log
    shorter than that. Shape (m,), m <= n."""
    later = np.searchsorted(time, time + 1.0 - 1e-9)
    inside = later[later < len(time)]
    return inside if len(inside) else np.array([len(time) - 1])
