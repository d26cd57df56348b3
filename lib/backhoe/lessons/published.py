"""Numbers as the sources print them, read from `data/published/`.

Each file holds one table or section of a source, with the printed signs, digits and units. What the
course uses instead, and why, is in `backhoe.machine` and in the lessons.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

__all__ = ["FOLDER", "load", "names"]

FOLDER = Path(__file__).resolve().parents[3] / "data" / "published"


def names(folder: Path | None = None) -> tuple[str, ...]:
    """Names that `load` accepts, sorted."""
    return tuple(sorted(path.stem for path in Path(folder or FOLDER).glob("*.toml")))


def load(name: str, folder: Path | None = None) -> dict:
    """One printed table or section.

    Args:
        name: file name without its ending, such as "mastalli_2013_table_a2".
        folder: where the files are; the repository's `data/published` unless told.

    Returns:
        The file's entries; "source" names the book and table, units are stated in the file.

    Raises:
        FileNotFoundError: there is no such file; the message names it and those that exist.
    """
    path = Path(folder or FOLDER) / f"{name}.toml"
    if not path.is_file():
        there = ", ".join(names(folder)) or "none (is this a full copy of the repository?)"
        raise FileNotFoundError(f"no published data {path}; there are: {there}")
    return tomllib.loads(path.read_text(encoding="utf-8"))
