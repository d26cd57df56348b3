"""Where the course lies on this machine, the student's own copy of it, and JupyterLab on that copy.

A copy has no stored outputs, so a prediction comes before its answer, and the course's own files
stay as they are. An update never takes anything of the student's: what was edited is kept, and a
newer version is put beside it.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Sequence
from hashlib import sha256
from pathlib import Path
from threading import get_ident

RECORD = ".backhoe.json"
"""In a workspace: of each file that the course put there, the digest."""

HOME = "backhoe-lessons"
"""The workspace's name in the home folder, where the course itself cannot be written."""


def root() -> Path:
    """The course's folder: the one with `notebooks/`, `lib/` and `requirements.txt`.

    Raises:
        FileNotFoundError: this library was installed without the course around it.
    """
    folder = Path(__file__).resolve().parents[3]
    if not (folder / "notebooks").is_dir():
        raise FileNotFoundError(
            f"no notebooks beside {folder}: install the course from its own folder with "
            "`pip install -r requirements.txt`"
        )
    return folder


def default_folder() -> Path:
    """Where the student's copy is made unless another folder is named: `workspace` in the course,
    or in the home folder where the course cannot be written."""
    inside = root() / "workspace"
    writable = os.access(inside if inside.is_dir() else root(), os.W_OK)
    return inside if writable else Path.home() / HOME


def update(folder: str | Path | None = None) -> list[str]:
    """Bring the student's copy of the lessons up to date, or make it.

    Missing notebooks are added, those that nobody touched replaced. Where the student changed one
    (running it counts), the course's newer version comes beside it, as `NAME.new.ipynb`. What the
    course no longer has stays where it was changed, and is moved into the folder `old` otherwise.

    Args:
        folder: the workspace; `default_folder()` if None.

    Returns:
        What was done, one line a file; nothing for what is up to date.

    Raises:
        OSError: the folder cannot be written, or the disk is full; what was there stays.
    """
    folder = default_folder() if folder is None else Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    given, said = _record(folder)
    lessons = dict(_lessons())
    for name in sorted(given.keys() - lessons):
        said += _retire(folder, name, given.pop(name))
        _write(folder / RECORD, json.dumps(given, indent=1).encode())
    for name, content in lessons.items():
        place, digest = folder / name, _digest(content)
        there = _digest(place.read_bytes()) if place.exists() else None
        if there is not None and given.get(name) == digest:
            continue
        if there is None:
            _write(place, content)
            said.append(f"new: {name}")
        elif there == given.get(name):
            _write(place, content)
            said.append(f"newer version: {name}")
        elif there != digest:
            beside = _beside(place, content)
            _write(beside, content)
            said.append(f"{name} is yours and stays; newer version: {beside.name}")
        given[name] = digest
        _write(folder / RECORD, json.dumps(given, indent=1).encode())
    return said


def open_lab(arguments: Sequence[str] = (), folder: str | Path | None = None) -> None:
    """Open JupyterLab on the tour in the student's own copy; it runs until it is stopped.

    Args:
        arguments: passed on to JupyterLab, such as `--no-browser`.
        folder: of the copy, which is made or brought up to date; `default_folder()` if None.

    Raises:
        ModuleNotFoundError: JupyterLab is not installed.
        FileNotFoundError: the notebooks are not beside the library.
        OSError: the copy cannot be written.
    """
    try:
        from jupyterlab.labapp import LabApp
    except ModuleNotFoundError as error:
        fix = "`backhoe doctor` says what to install"
        raise ModuleNotFoundError(f"JupyterLab is missing ({error}); {fix}") from error

    folder = (default_folder() if folder is None else Path(folder)).resolve()
    said = update(folder)
    print(f"your own copy of the lessons: {folder}", *said, sep="\n  ", flush=True)
    settings = str(Path(__file__).with_name("jupyter"))  # no news, no question about them
    paths = [settings, *filter(None, [os.environ.get("JUPYTER_CONFIG_PATH")])]
    os.environ["JUPYTER_CONFIG_PATH"] = os.pathsep.join(paths)
    tour = str(folder / "00_tour.ipynb")
    LabApp.launch_instance([tour, f"--ServerApp.root_dir={folder}", *arguments])


def _lessons() -> Iterator[tuple[str, bytes]]:
    """Name in the workspace and content of each file that a student gets."""
    notebooks = root() / "notebooks"
    for path in sorted(notebooks.rglob("[0-9]*.ipynb")):
        if ".ipynb_checkpoints" not in path.parts:
            yield path.relative_to(notebooks).as_posix(), _without_outputs(path)
    for path in sorted((root() / "docs").glob("*.png")):
        yield f"docs/{path.name}", path.read_bytes()


def _without_outputs(path: Path) -> bytes:
    notebook = json.loads(path.read_text(encoding="utf-8"))
    for cell in notebook["cells"]:
        source = "".join(cell["source"]).replace("](../docs/", "](docs/")
        cell["source"] = source.splitlines(keepends=True)
        if cell["cell_type"] == "code":
            cell["outputs"], cell["execution_count"] = [], None
    return (json.dumps(notebook, indent=1, ensure_ascii=False) + "\n").encode()


def _record(folder: Path) -> tuple[dict[str, str], list[str]]:
    """What the course put here, and what to say of a record that cannot be read."""
    path = folder / RECORD
    try:
        given = json.loads(path.read_bytes())
        if isinstance(given, dict) and all(isinstance(digest, str) for digest in given.values()):
            return given, []
    except FileNotFoundError:
        return {}, []
    except ValueError:
        pass
    aside = path.with_name(f"{RECORD}.damaged")
    path.replace(aside)
    return {}, [f"the list of what was copied was damaged; it is now {aside.name}"]


def _retire(folder: Path, name: str, digest: str) -> list[str]:
    """Put aside what the course no longer has; nothing is deleted."""
    place = folder / name
    try:
        content = place.read_bytes()
        if _digest(content) != digest:
            return [f"{name} is yours and stays; the course has no notebook of that name any more"]
        aside = _beside(folder / "old" / name, content, itself=True)
        aside.parent.mkdir(parents=True, exist_ok=True)
        place.replace(aside)
    except FileNotFoundError:
        return []
    return [f"{name} is no longer in the course; it is now {aside.relative_to(folder).as_posix()}"]


def _beside(place: Path, content: bytes, itself: bool = False) -> Path:
    """A free name beside a notebook (or its own, if it may be), or that of the same content."""
    if itself and not place.exists():
        return place
    number = 0
    while True:
        number += 1
        other = place.with_suffix(f".new{'' if number == 1 else number}{place.suffix}")
        if not other.exists() or other.read_bytes() == content:
            return other


def _write(place: Path, content: bytes) -> None:
    """The whole file or nothing of it, whatever happens meanwhile."""
    place.parent.mkdir(parents=True, exist_ok=True)
    half = place.with_name(f".{place.name}.{os.getpid()}.{get_ident()}")
    try:
        with half.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        half.replace(place)
    finally:
        half.unlink(missing_ok=True)


def _digest(content: bytes) -> str:
    return sha256(content).hexdigest()
