"""A drive's columns with their units, and how they are written."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import pi
from os import PathLike

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, whole
from backhoe.localisation.odometry.encoder import Encoder

UNITS = ("s", "rad", "rad/s", "m", "m/s", "m/s^2", "ticks", "1")
"""Units that columns are kept in."""

CONVERSIONS = {
    "ms": ("s", 1e-3),
    "us": ("s", 1e-6),
    "deg": ("rad", pi / 180),
    "deg/s": ("rad/s", pi / 180),
    "rpm": ("rad/s", pi / 30),
    "mm": ("m", 1e-3),
    "cm": ("m", 1e-2),
    "mm/s": ("m/s", 1e-3),
    "km/h": ("m/s", 1 / 3.6),
    "g": ("m/s^2", 9.80665),
}
"""Units that a header may name, what they become, and by which factor."""

KINDS = {
    "t": ("s",),
    **dict.fromkeys(("left", "right"), ("rad", "ticks")),
    **dict.fromkeys(("left_rate", "right_rate", "gyro", "omega"), ("rad/s",)),
    **dict.fromkeys(("psi", "yaw", "roll", "pitch"), ("rad",)),
    **dict.fromkeys(("x", "y", "z"), ("m",)),
    "v": ("m/s",),
    **dict.fromkeys(("ax", "ay", "az"), ("m/s^2",)),
}
"""Columns whose meaning is known, and the units in which they make sense."""

_LABEL = re.compile(r"(?P<name>[A-Za-z_]\w*) ?\[(?P<unit>[^\[\]]+)\]", re.ASCII)


@dataclass(frozen=True, eq=False)
class DriveLog:
    """One drive: times and columns, SI units and radians.

    Attributes:
        time: rising, shape (n,) [s].
        columns: values by name, each (n,), read-only.
        units: unit of each column, one of `UNITS`.
        comments: what the file says above its header.
        converted: what was converted on reading, such as "psi from deg".
    """

    time: NDArray
    columns: Mapping[str, NDArray]
    units: Mapping[str, str]
    comments: tuple[str, ...] = ()
    converted: tuple[str, ...] = field(default=())

    def __len__(self) -> int:
        return len(self.time)

    def __contains__(self, name: str) -> bool:
        return name in self.columns

    def __getitem__(self, name: str) -> NDArray:
        """The column `name`, shape (n,); KeyError that lists the columns if it is not there."""
        if name not in self.columns:
            raise KeyError(f"this log has no column {name!r}; it has {', '.join(self.columns)}")
        return self.columns[name]

    def __repr__(self) -> str:
        names = ", ".join(label(name, unit) for name, unit in self.units.items())
        return f"DriveLog({len(self)} rows, {self.duration:.2f} s, {names})"

    @property
    def duration(self) -> float:
        """From the first row to the last [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def period(self) -> float:
        """Median time between rows [s]."""
        return float(np.median(np.diff(self.time)))

    @property
    def pose(self) -> NDArray:
        """x, y, psi, shape (n, 3) [m, m, rad]; KeyError if the log has none."""
        return np.stack([self["x"], self["y"], self["psi"]], axis=-1)

    def angles(self, encoder: Encoder | None = None) -> tuple[NDArray, NDArray]:
        """Angles that the wheels turned since the first row, left and right, (n,) each [rad].

        Args:
            encoder: of the wheels, needed when the columns are ticks; overflows are undone.

        Raises:
            KeyError: the log has no columns left and right.
            ValueError: they are ticks and there is no encoder, or readings that it cannot show.
        """
        sides = []
        for name in ("left", "right"):
            values = self[name]
            if self.units[name] == "ticks":
                if encoder is None:
                    raise ValueError(
                        f"{name} is in ticks: say what they are with angles(Encoder(ticks=...))"
                    )
                sides.append(encoder.angles(values))
            else:
                sides.append(values - values[0])
        return sides[0], sides[1]


def write(
    file: str | PathLike,
    columns: DriveLog | Mapping[str, ArrayLike],
    *,
    comments: Sequence[str] = (),
    digits: int | None = None,
) -> None:
    """Write a log as `read` reads it.

    Args:
        file: name of the file; replaced if it is there.
        columns: a log, or arrays (n,) by labels such as "t [s]", "left [rad]", "x [m]"; units of
            `UNITS`, times first.
        comments: lines for above the header, such as the seed and the command; a log's own are kept
            in front.
        digits: significant digits; default as many as the numbers have.

    Raises:
        ValueError: a label without a name or unit that fits, columns of different length, a value
            that is not finite, a comment with a line break, digits that is not a whole number.
    """
    if isinstance(columns, DriveLog):
        comments = (*columns.comments, *comments)
        labels = [label(name, unit) for name, unit in columns.units.items()]
        values = list(columns.columns.values())
        columns = {"t [s]": columns.time} | dict(zip(labels, values, strict=True))
    if digits is not None:
        whole(digits, "digits", least=1, most=17)
    if any("\n" in comment or "\r" in comment for comment in comments):
        raise ValueError("a comment must be one line: give several")
    table = _table(columns)
    number = repr if digits is None else lambda value: format(value, f".{digits}g")
    with open(file, "w", encoding="utf-8", newline="") as stream:
        stream.writelines(f"# {comment}\n" for comment in comments)
        stream.write(",".join(columns) + "\n")
        stream.writelines(",".join(map(number, row)) + "\n" for row in table)


def label(name: str, unit: str) -> str:
    """A column's label in the header, such as "left [rad]"."""
    return f"{name} [{unit}]"


def split_label(text: str) -> tuple[str, str]:
    """Name and unit of a label; ValueError, said for a reader of the header, if it is none."""
    match = _LABEL.fullmatch(text)
    if match is None:
        raise ValueError(f"{text!r} must be a name with its unit, such as 'left [rad]' or 't [s]'")
    name, unit = match["name"], match["unit"].strip()
    base = CONVERSIONS.get(unit, (unit, 1.0))[0]
    if base not in UNITS:
        raise ValueError(
            f"the unit of {text!r} is not known: use one of {', '.join((*UNITS, *CONVERSIONS))}"
        )
    if name in KINDS and base not in KINDS[name]:
        raise ValueError(f"{name!r} is measured in {' or '.join(KINDS[name])}, got {text!r}")
    return name, unit


def _table(columns: Mapping[str, ArrayLike]) -> list[list[float]]:
    arrays = []
    for text, values in columns.items():
        unit = split_label(text)[1]
        if unit not in UNITS:
            raise ValueError(f"{text!r}: write {CONVERSIONS[unit][0]} instead of {unit}")
        array = numbers(values, text, ("n",)) + 0.0
        counts = unit == "ticks" and (array == np.floor(array)).all()
        arrays.append(array.astype(int) if counts else array)
    if len({len(array) for array in arrays}) != 1:
        lengths = {text: len(array) for text, array in zip(columns, arrays, strict=True)}
        raise ValueError(f"all columns must be of one length, got {lengths}")
    if next(iter(columns)) != "t [s]":
        raise ValueError(f"the first column must be 't [s]', got {next(iter(columns))!r}")
    return list(map(list, zip(*(array.tolist() for array in arrays), strict=True)))
