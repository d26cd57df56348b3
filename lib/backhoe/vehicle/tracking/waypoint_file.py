"""Way-point files: a line a point, `x,y` in metres or `x,y,t` with the time in seconds.

The first line is the header, the decimal mark a point. D'Angelo 2022 (section 5.4) loads such a
file too, there without a header and without saying what happens to a bad cell. Here nothing is
guessed and no line is left out: a file that is not as it should be is refused, with the line (the
header is line 1) and the column to look at. Units cannot be told from numbers, so they are not
guessed either: the length in a path's printed form shows centimetres read as metres.
"""

from __future__ import annotations

import csv
import re
from os import PathLike, fspath

import numpy as np
from numpy.typing import NDArray

_HEADERS = (["x", "y"], ["x", "y", "t"])
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)


def read(file: str | PathLike) -> tuple[NDArray, NDArray | None]:
    """Way-points of a CSV file.

    Args:
        file: name of the file; UTF-8, with or without a byte order mark.

    Returns:
        Points (n, 2) [m], and times (n,) [s] or None if the file has no column t.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: no header or another one, a cell that is empty, text, NaN or infinite, a line
            with too few or too many cells, an empty line between others, fewer than two points,
            times that do not rise. The message names the file, the line and the column.
    """
    name = fspath(file)
    lines = _lines(name)
    columns = _header(name, lines)
    rows = []
    for number, cells in lines[1:]:
        rows.append(_row(name, number, cells, columns))
    if len(rows) < 2:
        raise ValueError(f"{name} has {len(rows)} way-points: a path needs 2 or more")
    table = np.array(rows)
    if len(columns) == 2:
        return table, None
    _check_times(name, table[:, 2], [number for number, _ in lines[1:]])
    return table[:, :2].copy(), table[:, 2].copy()


def write(file: str | PathLike, points: NDArray, times: NDArray | None = None) -> None:
    """Write way-points as `read` reads them, every digit kept.

    Args:
        file: name of the file; replaced if it is there.
        points: shape (n, 2) [m].
        times: shape (n,) [s], or None for two columns.
    """
    table = points if times is None else np.column_stack([points, times])
    with open(file, "w", encoding="utf-8", newline="") as stream:
        stream.write(",".join("xyt"[: table.shape[1]]) + "\n")
        stream.writelines(",".join(map(repr, row)) + "\n" for row in table.tolist())


def _lines(name: str) -> list[tuple[int, list[str]]]:
    try:
        with open(name, encoding="utf-8-sig", newline="") as stream:
            reader = csv.reader(stream)
            lines = [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader]
    except (UnicodeDecodeError, csv.Error) as error:
        raise ValueError(f"{name} is not a CSV text file: {error}") from error
    while lines and not any(lines[-1][1]) and len(lines[-1][1]) < 2:
        lines.pop()
    if not lines:
        raise ValueError(f"{name} is empty: the first line must be x,y or x,y,t")
    return lines


def _header(name: str, lines: list[tuple[int, list[str]]]) -> list[str]:
    number, cells = lines[0]
    if cells in _HEADERS:
        return cells
    wanted = f"{name}, line {number}: the header must be x,y or x,y,t (metres, seconds)"
    if any(";" in cell or "\t" in cell for cell in cells):
        raise ValueError(
            f"{wanted}, got {','.join(cells)!r}: save it with commas between the columns and a "
            "point as the decimal mark"
        )
    if cells and all(_NUMBER.fullmatch(cell) for cell in cells):
        raise ValueError(f"{wanted}, got the numbers {','.join(cells)!r}: add the header")
    for column, (cell, expected) in enumerate(zip(cells, "xyt", strict=False), start=1):
        if cell != expected:
            raise ValueError(f"{wanted}, got {cell!r} for {expected!r} in column {column}")
    raise ValueError(f"{wanted}, got {len(cells)} columns: {','.join(cells)!r}")


def _row(name: str, number: int, cells: list[str], columns: list[str]) -> list[float]:
    if not any(cells) and len(cells) < 2:
        raise ValueError(f"{name}, line {number} is empty: take it out or fill it in")
    if len(cells) != len(columns):
        hint = ""
        if any(";" in cell for cell in cells) or len(cells) == 2 * len(columns):
            hint = "; use commas between the columns and a point as the decimal mark"
        raise ValueError(
            f"{name}, line {number}: expected {len(columns)} cells ({','.join(columns)}), "
            f"got {len(cells)}: {','.join(cells)!r}{hint}"
        )
    return [
        _number(f"{name}, line {number}, column {column}", cell)
        for column, cell in zip(columns, cells, strict=True)
    ]


def _number(where: str, cell: str) -> float:
    if _NUMBER.fullmatch(cell) and np.isfinite(float(cell)):
        return float(cell)
    if not cell:
        raise ValueError(f"{where} is empty: expected a number")
    if _NUMBER.fullmatch(cell.replace(",", ".")):
        raise ValueError(f"{where}: {cell!r} is not a finite number; write 1.5, not 1,5")
    raise ValueError(f"{where}: {cell!r} is not a finite number")


def _check_times(name: str, times: NDArray, numbers: list[int]) -> None:
    falls = np.flatnonzero(np.diff(times) <= 0)
    if len(falls):
        k = falls[0]
        raise ValueError(
            f"{name}, line {numbers[k + 1]}, column t: {times[k + 1]} s does not come after "
            f"{times[k]} s in the line before; times must rise"
        )
    if times[0] < 0:
        raise ValueError(f"{name}, line {numbers[0]}, column t: {times[0]} s is negative")
