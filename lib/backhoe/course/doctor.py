"""`backhoe doctor`: is everything here that the lessons need, and if not, what to type.

Only the standard library is imported, so that it runs however little is installed. What might
crash or hang runs in a process of its own.
"""

from __future__ import annotations

import operator
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

from backhoe.course import workspace

OLDEST, NEWEST = (3, 11), (3, 13)
_BULLETS = ("pybullet", "pybullet_arm64")
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome", "msedge")

_COMPARISONS = {"==": operator.eq, "!=": operator.ne, "<": operator.lt, ">=": operator.ge}

_RENDER = """
import pybullet, numpy
world = pybullet.connect(pybullet.DIRECT)
shape = pybullet.createVisualShape(pybullet.GEOM_SPHERE, 0.5, physicsClientId=world)
pybullet.createMultiBody(0, -1, shape, physicsClientId=world)
view = pybullet.computeViewMatrix([0, -3, 0], [0, 0, 0], [0, 0, 1])
lens = pybullet.computeProjectionMatrixFOV(40, 1.0, 0.1, 10)
image = pybullet.getCameraImage(64, 64, view, lens, renderer=pybullet.ER_TINY_RENDERER,
                                physicsClientId=world)
depth = numpy.reshape(numpy.array(image[3], float), (64, 64))
pybullet.disconnect(world)
assert depth[32, 32] < depth[0, 0], "the sphere is not in the picture"
"""
_COMPILE = """
import numba
assert numba.njit(lambda x: x + 1)(1) == 2
"""
_KERNEL = """
from jupyter_client.manager import start_new_kernel
manager, client = start_new_kernel(kernel_name="python3", startup_timeout=60)
try:
    reply = client.execute_interactive("import backhoe", timeout=60)
finally:
    client.stop_channels()
    manager.shutdown_kernel(now=True)
assert reply["content"]["status"] == "ok", reply["content"].get("evalue")
"""


class Finding(NamedTuple):
    """One thing looked at: `well` is True, False, or None where it is only for information.

    `fix` is what to type or to do when something is wrong.
    """

    name: str
    well: bool | None
    detail: str
    fix: str = ""


class Pin(NamedTuple):
    """One package of requirements.txt and the version that the lessons were made with."""

    name: str
    version: str


def pins(requirements: str) -> list[Pin]:
    """The packages that a requirements file pins for this interpreter and this machine.

    Args:
        requirements: the text of the file; lines as `name==version ; marker  # why`.

    Raises:
        ValueError: a line is no pin, or its marker is not understood.
    """
    found = []
    for line in requirements.splitlines():
        text = re.sub(r"(^|\s)#.*", "", line).strip()
        if not text or text.startswith("-"):
            continue
        pin, _, marker = text.partition(";")
        match = re.fullmatch(r"([\w.-]+)==([\w.]+)", pin.strip())
        if match is None:
            raise ValueError(f"expected `name==version` in requirements.txt, got {line!r}")
        if not marker.strip() or _holds(marker):
            found.append(Pin(*match.groups()))
    return found


def examine() -> list[Finding]:
    """Look at everything, in the order in which it should be put right."""
    try:
        wanted = pins((workspace.root() / "requirements.txt").read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        return [_interpreter(), Finding("course", False, str(error), "clone the whole course")]
    return [
        _interpreter(),
        *(_package(pin) for pin in wanted if not _is_bullet(pin)),
        *_bullet([pin for pin in wanted if _is_bullet(pin)]),
        _trial("numba compiles", "numba", _COMPILE),
        _trial("Jupyter kernel", "ipykernel", _KERNEL),
        _browser(),
    ]


def report(findings: Iterable[Finding]) -> int:
    """Print the findings and return the exit code: 0 only when nothing is wrong."""
    findings = list(findings)
    for finding in findings:
        mark = {True: "ok   ", False: "WRONG", None: "note "}[finding.well]
        print(f"{mark}  {finding.name}: {finding.detail}")
        if finding.fix:
            print(f"       fix: {finding.fix}")
    wrong = sum(finding.well is False for finding in findings)
    print("All is well." if not wrong else f"{wrong} to put right, the first one first.")
    return 1 if wrong else 0


def _interpreter() -> Finding:
    version = sys.version_info[:2]
    detail = f"Python {platform.python_version()} at {sys.executable}"
    if OLDEST <= version <= NEWEST:
        return Finding("interpreter", True, detail)
    wanted = f"{OLDEST[0]}.{OLDEST[1]} to {NEWEST[0]}.{NEWEST[1]}"
    fix = f"install Python 3.11, remove the folder .venv and set up again (needs {wanted})"
    return Finding("interpreter", False, detail, fix)


def _installed(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _pip(*arguments: str) -> str:
    command = [sys.executable, "-m", "pip", *arguments]
    return subprocess.list2cmdline(command) if os.name == "nt" else shlex.join(command)


def _package(pin: Pin) -> Finding:
    version = _installed(pin.name)
    if version is not None and _agree(version, pin.version):
        return Finding(pin.name, True, version)
    came = "is missing" if version is None else f"is {version}"
    fix = _pip("install", f"{pin.name}=={pin.version}")
    return Finding(pin.name, False, f"{came}, wanted {pin.version}", fix)


def _agree(version: str, wanted: str) -> bool:
    """Equal; conda's environment.yml leaves the last number open."""
    if Path(sys.prefix, "conda-meta").is_dir():
        return version.split(".")[:2] == wanted.split(".")[:2]
    return version == wanted


def _is_bullet(pin: Pin) -> bool:
    return pin.name.replace("-", "_") in _BULLETS


def _bullet(wanted: list[Pin]) -> list[Finding]:
    names = [name for name in _BULLETS if _installed(name)]
    if len(names) == 2:
        detail = "pybullet and pybullet_arm64 are both installed and overwrite each other"
        requirements = str(workspace.root() / "requirements.txt")
        fix = f"{_pip('uninstall', '-y', *names)} && {_pip('install', '-r', requirements)}"
        return [Finding("PyBullet", False, detail, fix)]
    if not names and not wanted:
        detail = "not built for this system and Python; the lessons use the analytic machine"
        return [Finding("PyBullet", None, detail)]
    if not names:
        pin = f"{wanted[0].name}=={wanted[0].version}"
        return [Finding("PyBullet", False, "is missing", _pip("install", pin))]
    return [
        Finding("PyBullet", True, f"{names[0]} {_installed(names[0])}"),
        _trial("PyBullet renders without a screen", names[0], _RENDER),
    ]


def _trial(name: str, package: str, code: str) -> Finding:
    """Run the code in a new interpreter; what fails is put right by installing the package anew."""
    version = _installed(package)
    again = _pip("install", "--force-reinstall", "--no-deps", f"{package}=={version}")
    fix = again if version else _pip("install", package)
    try:
        done = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, timeout=180, check=False
        )
    except subprocess.TimeoutExpired:
        return Finding(name, False, "no answer within 180 s", fix)
    if done.returncode == 0:
        return Finding(name, True, "yes")
    last = (done.stderr.strip() or f"stopped with code {done.returncode}").splitlines()[-1]
    return Finding(name, False, last, fix)


def _browser() -> Finding:
    missing = "no Chromium; only the browser tests need one"
    found = next(filter(None, map(shutil.which, BROWSERS)), missing)
    return Finding("browser for the tests", None, found)


def _holds(marker: str) -> bool:
    return any(all(map(_compare, either.split(" and "))) for either in marker.split(" or "))


def _compare(clause: str) -> bool:
    match = re.fullmatch(r'\s*(\w+)\s*(==|!=|<|>=)\s*"([^"]*)"\s*', clause)
    here = {
        "sys_platform": sys.platform,
        "platform_machine": platform.machine(),
        "python_version": ".".join(map(str, sys.version_info[:2])),
    }
    if match is None or match[1] not in here:
        raise ValueError(f"marker not understood: {clause.strip()!r}")
    ours, theirs = here[match[1]], match[3]
    if match[1] == "python_version":
        ours, theirs = ([int(n) for n in version.split(".")] for version in (ours, theirs))
    return _COMPARISONS[match[2]](ours, theirs)
