"""Reading a log, line by line.

Nothing is guessed, filled in or left out. What is wrong is named by its line in the file and its
column, the way an editor counts: the first line is 1, comments and the header included.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from os import PathLike, fspath
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import number
from backhoe.localisation.drive_log.log import CONVERSIONS, DriveLog, label, split_label
from backhoe.localisation.drive_log.plausible import check

MAX_GAP = 5.0
"""Longest time between two rows, in median periods."""

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)


@dataclass(frozen=True)
class _Text:
    """A file as text: its lines by number, the header's columns as (name, unit)."""

    name: str
    comments: tuple[str, ...]
    columns: list[tuple[str, str]]
    numbers: list[int]
    rows: list[list[str]]

    def where(self, row: int, column: int) -> str:
        return f"{self.name}, line {self.numbers[row]}, column {label(*self.columns[column])}"


def read(
    file: str | PathLike,
    *,
    require: Sequence[str] = ("left", "right"),
    max_gap: float = MAX_GAP,
    limits: Mapping[str, float | None] | None = None,
    unwrap: bool = False,
) -> DriveLog:
    """A log from a CSV file: a header with units, a row for each time, a point as decimal mark.

    Lines that start with # above the header are comments. Column t must be there; names that have
    a meaning are listed in `log.KINDS`, others may be there as well. Degrees, millimetres and the
    like are converted when the header names them, which `DriveLog.converted` tells; where the
    header says radians and the numbers look like degrees, the log is refused.

    Args:
        file: name of the file; UTF-8.
        require: columns that must be there beside t.
        max_gap: longest time between rows, in median periods; inf for any.
        limits: replaces single entries of `LIMITS`, the largest believable rates, by column; None
            as a value believes everything.
        unwrap: put a heading psi that jumps by whole turns together again, instead of refusing it.

    Returns:
        The log, SI units and radians.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: no header or one without units, a missing or double column, a cell that is
            empty, text, NaN or infinite, a row with too few or too many cells, fewer than 3 rows,
            times that do not rise, a gap, a counter that was reset, a wrapped heading, or numbers
            that do not fit their unit. The message names the file, the line and the column.
    """
    text = _text(fspath(file), require)
    table = _numbers(text)
    factors = [CONVERSIONS.get(unit, (unit, 1.0)) for _, unit in text.columns]
    table = table * [factor for _, factor in factors]
    units = {name: base for (name, _), (base, _) in zip(text.columns, factors, strict=True)}
    columns = dict(zip(units, table.T, strict=True))
    time = columns["t"]
    _check_times(text, time, max_gap, list(units).index("t"))
    if unwrap and "psi" in columns:
        columns["psi"] = np.unwrap(columns["psi"])
    places = list(units)
    check(
        columns,
        units,
        lambda row, name: text.where(row, places.index(name)),
        text.name,
        limits or {},
    )
    for values in columns.values():
        values.setflags(write=False)
    del columns["t"], units["t"]
    return DriveLog(
        time,
        MappingProxyType(columns),
        MappingProxyType(units),
        text.comments,
        tuple(f"{name} from {unit}" for name, unit in text.columns if unit in CONVERSIONS),
    )


def _text(name: str, require: Sequence[str]) -> _Text:
    comments = []
    try:
        with open(name, encoding="utf-8-sig") as stream:
            raw = stream.read().split("\n")
        while raw and raw[0].startswith("#"):
            comments.append(raw.pop(0)[1:].strip())
        reader = csv.reader(raw)
        lines = [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader]
    except (UnicodeDecodeError, csv.Error) as error:
        raise ValueError(f"{name} is not a CSV text file: {error}") from error
    lines = [(len(comments) + line, cells) for line, cells in lines]
    while lines and not any(lines[-1][1]) and len(lines[-1][1]) < 2:
        lines.pop()
    if not lines:
        raise ValueError(f"{name} is empty: it needs a header such as t [s],left [rad],right [rad]")
    header, cells = lines.pop(0)
    columns = _header(f"{name}, line {header}", cells, require)
    if len(lines) < 3:
        raise ValueError(f"{name} has {len(lines)} rows below its header: a log needs 3 or more")
    numbers, rows = zip(*lines, strict=True)
    return _Text(name, tuple(comments), columns, list(numbers), list(rows))


def _header(where: str, cells: list[str], require: Sequence[str]) -> list[tuple[str, str]]:
    if any(";" in cell or "\t" in cell for cell in cells):
        raise ValueError(
            f"{where}: the header {','.join(cells)!r} has no commas between its columns: save it "
            "with commas, and a point as the decimal mark"
        )
    if cells and all(_NUMBER.fullmatch(cell) for cell in cells):
        raise ValueError(
            f"{where}: the header is missing, there are numbers: put names and units above them, "
            "such as t [s],left [rad],right [rad]"
        )
    columns = []
    for place, cell in enumerate(cells, start=1):
        try:
            columns.append(split_label(cell))
        except ValueError as error:
            raise ValueError(f"{where}, column {place}: {error}") from None
    names = [name for name, _ in columns]
    for name in ("t", *require):
        if name not in names:
            raise ValueError(f"{where}: column {name!r} is missing; there are {', '.join(cells)}")
        if names.count(name) > 1:
            raise ValueError(f"{where}: column {name!r} is there {names.count(name)} times")
    double = next((name for name in names if names.count(name) > 1), None)
    if double is not None:
        raise ValueError(f"{where}: column {double!r} is there {names.count(double)} times")
    return columns


def _numbers(text: _Text) -> NDArray:
    """The cells as numbers, shape (n, columns); the first bad one is named."""
    count = len(text.columns)
    for line, cells in zip(text.numbers, text.rows, strict=True):
        if len(cells) != count:
            raise ValueError(_ragged(f"{text.name}, line {line}", cells, text.columns))
    table = np.empty((len(text.rows), count))
    for row, cells in enumerate(text.rows):
        try:
            table[row] = [float(cell) for cell in cells]
        except ValueError:
            table[row] = np.nan
    plain = np.array(["_" not in "".join(cells) for cells in text.rows])
    for row in np.flatnonzero(~np.isfinite(table).all(axis=1) | ~plain):
        for column, cell in enumerate(text.rows[row]):
            if not _NUMBER.fullmatch(cell) or abs(float(cell)) == inf:
                raise ValueError(_not_a_number(text.where(row, column), cell))
    return table


def _ragged(where: str, cells: list[str], columns: list[tuple[str, str]]) -> str:
    if not any(cells):
        return f"{where} is empty: take it out, and see that no time is missing there"
    hint = ""
    if len(cells) == 2 * len(columns) or any(";" in cell for cell in cells):
        hint = "; use commas between the columns and a point as the decimal mark"
    elif len(cells) < len(columns):
        hint = f"; is the file cut off, or {label(*columns[len(cells)])} missing?"
    return f"{where}: expected {len(columns)} cells, got {len(cells)}: {','.join(cells)!r}{hint}"


def _not_a_number(where: str, cell: str) -> str:
    if not cell:
        return f"{where} is empty: a log needs every value; interpolate it or take the row out"
    if cell.lower().lstrip("+-") in ("nan", "na", "null", "none"):
        return f"{where}: {cell!r} is no value; interpolate it or take the row out"
    return f"{where}: {cell!r} is not a finite number"


def _check_times(text: _Text, time: NDArray, max_gap: float, column: int) -> None:
    steps = np.diff(time)
    falls = np.flatnonzero(steps <= 0)
    if len(falls):
        k = int(falls[0])
        raise ValueError(
            f"{text.where(k + 1, column)}: {time[k + 1]:.10g} s does not come after "
            f"{time[k]:.10g} s in the row before; times must rise"
        )
    period = float(np.median(steps))
    max_gap = number(max_gap, "max_gap", "periods", least=1, finite=False)
    gaps = np.flatnonzero(steps > max_gap * period)
    if len(gaps):
        k = int(gaps[0])
        raise ValueError(
            f"{text.where(k + 1, column)}: a gap of {steps[k]:.4g} s after {time[k]:.10g} s, "
            f"{steps[k] / period:.0f} periods of {period:.4g} s; split the log there, or allow it "
            "with max_gap"
        )
