"""What was checked in a student's copy of the lessons: a line a check, in a file of the copy.

The file is only ever added to, a whole line at a time, so two kernels at once lose nothing. Outside
of a copy (the course's own notebooks, a script) nothing is written.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path

from backhoe.basics import inputs
from backhoe.course.workspace import RECORD

__all__ = ["FILE", "Checked", "Passed", "copy_around", "passed", "recall", "remember"]

FILE = ".backhoe-progress.jsonl"


@dataclass(frozen=True)
class Checked:
    """One check: the exercise's number, whether it was right, and when, in ISO 8601."""

    exercise: str
    right: bool
    when: str

    def __post_init__(self) -> None:
        if not isinstance(self.exercise, str):
            raise ValueError(f"an exercise is text, got {self.exercise!r}")
        inputs.flag(self.right, "right")
        datetime.fromisoformat(self.when)

    @classmethod
    def now(cls, exercise: str, right: bool) -> Checked:
        """A check of this moment."""
        return cls(exercise, right, datetime.now().astimezone().isoformat(timespec="seconds"))


@dataclass(frozen=True)
class Passed:
    """When an exercise was right for the first time, and at which try; `day` such as 28 Nov."""

    day: str
    tries: int


def copy_around(folder: Path | None = None) -> Path | None:
    """The student's copy that the folder (the current one if None) lies in, if it does."""
    try:
        folder = (folder or Path.cwd()).resolve()
    except OSError:
        return None
    return next((one for one in (folder, *folder.parents) if (one / RECORD).is_file()), None)


def remember(folder: Path | None, checks: Iterable[Checked]) -> bool:
    """Add checks to the file of a copy; whether that went well. It never raises."""
    text = "".join(f"\n{json.dumps(asdict(one))}\n" for one in checks)  # after half a line too
    if folder is None:
        return False
    try:
        file = os.open(folder / FILE, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
        try:
            return os.write(file, text.encode()) == len(text.encode())
        finally:
            os.close(file)
    except OSError:
        return False


def recall(folder: Path | None) -> tuple[list[Checked], list[str]]:
    """The checks of a copy in their order, and what to say of the file. It never raises.

    A damaged file is set aside whole; what could be read of it goes on in a new one.
    """
    if folder is None:
        return [], []
    path = folder / FILE
    try:
        found, damaged = _read(path)
        if not damaged:
            return found, []
        aside = _free(path)
        path.replace(aside)
        found, _ = _read(aside)
        remember(folder, found)
    except FileNotFoundError:
        return [], []
    except OSError as error:
        return [], [f"what was passed before cannot be read: {error.strerror}"]
    return found, [f"the file of what was passed was damaged; it is now {aside.name}"]


def passed(checks: Iterable[Checked]) -> dict[str, Passed]:
    """Of each exercise that was right once: when first, and at which try."""
    tries: dict[str, int] = {}
    found: dict[str, Passed] = {}
    for one in checks:
        tries[one.exercise] = tries.get(one.exercise, 0) + 1
        if one.right and one.exercise not in found:
            when = datetime.fromisoformat(one.when)
            found[one.exercise] = Passed(f"{when.day} {when:%b %Y}", tries[one.exercise])
    return found


def _read(path: Path) -> tuple[list[Checked], bool]:
    found, damaged = [], False
    for line in path.read_bytes().splitlines():
        try:
            if line.strip():
                found.append(Checked(**json.loads(line)))
        except (ValueError, TypeError):
            damaged = True
    return found, damaged


def _free(path: Path) -> Path:
    number = 1
    while True:
        aside = path.with_name(f"{path.name}.damaged{'' if number == 1 else number}")
        if not aside.exists():
            return aside
        number += 1
