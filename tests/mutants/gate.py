"""The mutation gate: faults put into the library one at a time, each of which a test must notice.

A mutant is one entry of the lists beside this file, one list a floor (`arm.toml`). For each, the
library is copied, the fault put in and the tests concerned are run in a process of its own. It is
killed when one of them fails by what it says; an import that breaks, a fixture or a compiler that
gives up, a crash or a timeout says nothing of the test and is an error of the list.

What compiled engines keep on disk is not looked at where it could be stale: a copy keeps the warm
caches, but for those of the engines that reach the file with the fault.
"""

from __future__ import annotations

import ast
import os
import shutil
import sys
import tempfile
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from time import process_time
from typing import NamedTuple

import pytest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
KINDS = {
    "sign": "a sign turned",
    "factor": "a number too large or too small",
    "index": "the wrong row, column or neighbour",
    "missing": "a term left out",
    "wrap": "an angle not wrapped, or wrapped where turns count",
    "gravity": "g left out or counted twice",
    "unit": "degrees for radians, milliseconds for seconds",
    "count": "one too many or too few",
    "axes": "axes or sides exchanged",
    "clamp": "a limit at the wrong place",
    "transpose": "a matrix turned over",
}
_WORKERS = 2
_LONGEST = 300
"""Seconds for one test; the tests concerned take less than ten where nothing else runs."""
_WARM = (
    *("pytest", "pytest_timeout", "numba", "control", "filterpy.kalman"),
    *("scipy.integrate", "scipy.interpolate", "scipy.linalg", "scipy.ndimage", "scipy.optimize"),
    "scipy.spatial",
)
"""What is imported once, before the processes part."""


@dataclass(frozen=True)
class Mutant:
    """`old`, once in `file` of the library, becomes `new`; `wrong` says what that does."""

    file: str
    kind: str
    wrong: str
    old: str
    new: str
    tests: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.file}: {self.wrong}"


class Verdict(NamedTuple):
    """Killed, survived or error, by which test or for which reason, and seconds of computing."""

    outcome: str
    by: str
    seconds: float


def mutants(folder: Path = HERE) -> list[Mutant]:
    """All entries of the lists in a folder, floor by floor."""
    found = []
    for path in sorted(folder.glob("*.toml")):
        for entry in tomllib.loads(path.read_text(encoding="utf-8"))["mutant"]:
            found.append(Mutant(**entry | {"tests": tuple(entry["tests"])}))
    return found


def faulty(mutant: Mutant, package: Path) -> str:
    """The text of the file with the fault; ValueError where the entry does not fit the library."""
    path = package / mutant.file
    text = path.read_text(encoding="utf-8") if path.is_file() else ""
    count = text.count(mutant.old)
    if count != 1:
        raise ValueError(f"its old text is {count} times in {mutant.file}, and must be once")
    text = text.replace(mutant.old, mutant.new)
    try:
        compile(text, mutant.file, "exec")
    except SyntaxError as error:
        raise ValueError(f"its new text is no Python: {error}") from error
    return text


def judge(
    chosen: Sequence[Mutant],
    *,
    root: Path = ROOT,
    say: Callable[[str], object] = print,
    passed: bool = False,
) -> dict[Mutant, Verdict]:
    """Run the tests concerned on the library as it is, then on each mutant.

    Args:
        chosen: the mutants; their tests are named from the folder `tests`.
        root: of the repository, with `lib/backhoe` and `tests`.
        say: gets a line about each mutant as soon as its verdict is there.
        passed: the tests concerned have just passed here without a mutant, and are not tried again.

    Raises:
        ValueError: a test concerned fails, or does not exist, without any mutant.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder, _workers() as pool:
        clean = _copy(root, Path(folder) / "clean", shutil.copy2)

        def sound(tests: list[str]) -> str:
            return _run(clean, tests, first_only=False).trouble

        trouble = [line for line in pool.map(sound, () if passed else _by_file(chosen)) if line]
        if trouble:
            raise ValueError("without any mutant: " + "; ".join(trouble))

        def judged(mutant: Mutant) -> Verdict:
            verdict = _judge_one(mutant, clean)
            say(f"{verdict.outcome:<8} {verdict.seconds:5.1f} s  {mutant} [{verdict.by}]")
            return verdict

        return dict(zip(chosen, pool.map(judged, chosen), strict=True))


def _judge_one(mutant: Mutant, clean: Path) -> Verdict:
    package = clean / "lib" / "backhoe"
    try:
        text = faulty(mutant, package)
    except ValueError as error:
        return Verdict("error", str(error), 0.0)
    with tempfile.TemporaryDirectory(dir=clean.parent) as folder:
        copy = _copy(clean, Path(folder) / "copy", os.link)
        path = copy / "lib" / "backhoe" / mutant.file
        stamp = path.stat().st_mtime + 60  # Python and Numba look at a file's time
        path.unlink()
        path.write_text(text, encoding="utf-8")
        os.utime(path, (stamp, stamp))
        for engine in _engines_that_reach(package, mutant.file):
            for kept in (copy / "lib" / "backhoe" / engine).parent.glob("__pycache__/*.nbi"):
                kept.unlink()
        found = _run(copy, mutant.tests, first_only=True)
    outcome = "killed" if found.failed else "error" if found.trouble else "survived"
    return Verdict(outcome, found.trouble or ", ".join(mutant.tests), found.seconds)


def _copy(root: Path, to: Path, by: Callable) -> Path:
    """A folder with a copy of the library, and with what else is in the repository by its links."""
    to.mkdir()
    for path in root.iterdir():
        if path.name != "lib":
            (to / path.name).symlink_to(path.resolve())
    nothing_installed = shutil.ignore_patterns("*.egg-info")
    shutil.copytree(root / "lib", to / "lib", copy_function=by, ignore=nothing_installed)
    return to


class _Found(NamedTuple):
    failed: list[str]  # tests that failed by what they say
    broken: list[str]  # what went wrong beside
    passed: int
    seconds: float  # of computing

    @property
    def trouble(self) -> str:
        nothing = [] if self.passed or self.failed or self.broken else ["no test was run"]
        return "; ".join(self.failed + self.broken + nothing)


def _run(copy: Path, tests: Iterable[str], first_only: bool) -> _Found:
    """What pytest finds in a process of its own with the library of a copy."""
    context = get_context("forkserver")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_in_a_process, args=(sender, copy, tests, first_only))
    process.start()
    sender.close()
    try:
        found = receiver.recv()
    except EOFError:
        found = _Found([], ["the process crashed"], 0, 0.0)
    process.join()
    return found


def _in_a_process(sender, copy: Path, tests: Iterable[str], first_only: bool) -> None:
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    os.dup2(nothing, 2)
    os.chdir((copy / "tests").resolve().parent)
    lib = copy / "lib"
    sys.path[:] = [str(lib), *(entry for entry in sys.path if entry != str(HERE))]
    os.environ.pop("PYTEST_ADDOPTS", None)
    os.environ |= {"PYTHONPATH": str(lib), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    watch = _Watch()
    options = ["-o", "addopts=", "--import-mode=importlib", "-p", "no:cacheprovider", "--tb=no"]
    options += ["-p", "pytest_timeout", f"--timeout={_LONGEST}", *(["-x"] if first_only else [])]
    code = pytest.main([*options, *(f"tests/{test}" for test in tests)], plugins=[watch])
    if code not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED) and not watch.broken:
        watch.broken.append(f"pytest ends with {code!r} for {', '.join(tests)}")
    sender.send(_Found(watch.failed, watch.broken, watch.passed, process_time()))


class _Watch:
    """A plugin that tells tests that fail by what they say from anything else."""

    def __init__(self) -> None:
        self.failed: list[str] = []
        self.broken: list[str] = []
        self.passed = 0

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item, call):
        report = yield
        if report.failed:
            says_so = call.when == "call" and not _says_nothing(call.excinfo)
            (self.failed if says_so else self.broken).append(
                report.nodeid if says_so else f"{report.nodeid}: {call.excinfo.exconly()[:200]}"
            )
        self.passed += report.passed and call.when == "call"
        return report

    def pytest_collectreport(self, report) -> None:
        if report.failed:
            self.broken.append(f"{report.nodeid}: {str(report.longrepr)[-200:]}")


def _says_nothing(error: pytest.ExceptionInfo) -> bool:
    """Whether an exception is of Python, of a compiler or of the clock, and not of the test."""
    compiler = error.type.__module__.startswith("numba")
    late = error.errisinstance(pytest.fail.Exception) and str(error.value).startswith("Timeout")
    return compiler or late or error.errisinstance((ImportError, NameError, SyntaxError))


@contextmanager
def _workers() -> Iterator[ThreadPoolExecutor]:
    context = get_context("forkserver")
    context.set_forkserver_preload(list(_WARM))
    with ThreadPoolExecutor(_WORKERS) as pool:
        yield pool


def _by_file(chosen: Iterable[Mutant]) -> list[list[str]]:
    """The tests concerned, each once, in groups of one file."""
    groups: dict[str, list[str]] = {}
    for test in sorted({test for mutant in chosen for test in mutant.tests}):
        groups.setdefault(test.split("::")[0], []).append(test)
    return list(groups.values())


def _engines_that_reach(package: Path, file: str) -> list[str]:
    """Engines that import a file of the library, or are it, by whatever way."""
    return [engine for engine, reached in _reached_by_engines(package).items() if file in reached]


@cache
def _reached_by_engines(package: Path) -> dict[str, set[str]]:
    """Each engine's file, with all files that it imports, itself among them."""
    imports = {
        str(path.relative_to(package)): set(_imported(path, package))
        for path in package.rglob("*.py")
    }
    found = {}
    for engine in (name for name in imports if name.endswith("engine.py")):
        reached, new = set(), {engine}
        while new:
            reached |= new
            new = set().union(*(imports.get(name, ()) for name in new)) - reached
        found[engine] = reached
    return found


def _imported(path: Path, package: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("backhoe"):
            for alias in node.names:
                for name in (node.module, f"{node.module}.{alias.name}"):
                    place = package.parent / name.replace(".", "/")
                    for file in (place.with_suffix(".py"), place / "__init__.py"):
                        if file.is_file():
                            yield str(file.relative_to(package))
