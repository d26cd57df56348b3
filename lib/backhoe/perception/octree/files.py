"""OctoMap's two kinds of file: a header of text lines, then the nodes as `stream` has them.

`.ot` keeps all log-odds, `.bt` only whether a leaf is occupied or free.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from backhoe.basics.inputs import choice, instance

FIRST_LINES = {".bt": b"# Octomap OcTree binary file", ".ot": b"# Octomap OcTree file"}
NOTE = b"# (feel free to add / change comments, but leave the first line as it is!)"
LONGEST = 4096
"""A header that is longer is none [bytes]."""

FULL = np.dtype([("odds", "<f4"), ("children", "u1")])
"""A node of `.ot`."""


class Content(NamedTuple):
    """What a file says: resolution [m], number of nodes, and the bytes after the header."""

    resolution: float
    size: int
    data: bytes


def suffix_of(path: str | Path) -> str:
    """`.bt` or `.ot`; ValueError for another, TypeError for what is no path."""
    instance(path, "path", (str, Path))
    return choice(Path(path).suffix, "the file's ending", tuple(FIRST_LINES))


def write(path: str | Path, content: Content) -> None:
    """Write a file whose ending says which of the two it is."""
    short, exact = f"{content.resolution:g}", repr(content.resolution)
    resolution = short if float(short) == content.resolution else exact
    lines = [
        FIRST_LINES[suffix_of(path)],
        NOTE,
        b"#",
        b"id OcTree",
        b"size %d" % content.size,
        b"res " + resolution.encode(),
        b"data",
    ]
    Path(path).write_bytes(b"\n".join(lines) + b"\n" + content.data)


def read(path: str | Path, largest: int) -> Content:
    """Read a file and check what its header claims against its length.

    Args:
        path: ends in `.bt` or `.ot`.
        largest: bytes of nodes that are accepted.

    Raises:
        ValueError: no such kind of file, a tree of another kind, a header that is not whole, or
            that claims other nodes than can be in the file, or more than accepted.
    """
    path, suffix = Path(path), suffix_of(path)
    with path.open("rb") as file:
        first = file.readline(LONGEST).rstrip()
        if not first.startswith(FIRST_LINES[suffix]):
            raise ValueError(
                f"{path.name} must begin with {FIRST_LINES[suffix].decode()!r}, got {first[:60]!r}"
            )
        said = _header(file, path.name)
        length = path.stat().st_size - file.tell()
        resolution, size = said["res"], said["size"]
        possible = 5 * size == length if suffix == ".ot" else length >= 2 and size <= 4 * length + 1
        if not (possible or (size == 0 and length == 0)):
            raise ValueError(
                f"{path.name} is cut short or damaged: it claims {size} nodes in {length} bytes"
            )
        if length > largest:
            raise ValueError(
                f"{path.name} has {length} bytes of nodes, more than the {largest} that are read"
            )
        return Content(resolution, size, file.read())


def _header(file, name: str) -> dict[str, float]:
    said: dict[str, float] = {}
    while (line := file.readline(LONGEST)) and file.tell() < LONGEST:
        word, _, rest = line.strip().partition(b" ")
        if word == b"data":
            break
        if word == b"id" and rest != b"OcTree":
            raise ValueError(f"{name} must hold an OcTree, got {rest[:40].decode('latin-1')!r}")
        try:
            if word == b"size":
                said["size"] = int(rest)
            elif word == b"res":
                said["res"] = float(rest)
        except ValueError as error:
            raise ValueError(
                f"{name}: {word.decode()} must be a number, got {rest[:40]!r}"
            ) from error
    else:
        raise ValueError(f"{name} must have a line 'data' in its first {LONGEST} bytes")
    if not (said.get("size", -1) >= 0 and 0 < said.get("res", 0) < np.inf):
        raise ValueError(f"{name} must say its size and its resolution above 0 m, got {said}")
    return said
