"""The drives as CSV in `data/drives/`: encoders, IMU and the truth, each in a file of its own.

Comments (#) say what it is, with which seed and noise, and the command that makes it; then comes a
header with units. The yaw is printed as it is, not wrapped.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from backhoe.drives.on_tracks import drive_the_machine
from backhoe.drives.recording import NOISE, SEED, SLIPPING, Recording, record
from backhoe.drives.scenarios import SCENARIOS

__all__ = ["FOLDER", "MACHINE", "TRUTH_RATE", "load", "names", "write"]

FOLDER = Path(__file__).resolve().parents[3] / "data" / "drives"

TRUTH_RATE = 20.0
"""Of the truth in the files [Hz]: a log of its own, slower than the sensors'."""

MACHINE = "backhoe"
"""The drive of the machine itself."""

_COMMAND = "python -m backhoe.drives"
_FILES = {
    "encoders": ("t [s],left [rad/s],right [rad/s]", "%.2f,%.3f,%.3f"),
    "imu": ("t [s],gyro [rad/s],yaw [rad]", "%.2f,%.3f,%.3f"),
    "truth": ("t [s],x [m],y [m],psi [rad]", "%.2f,%.4f,%.4f,%.4f"),
}


def names() -> tuple[str, ...]:
    """Names of the drives that `load` accepts."""
    slipping = tuple(f"{name}_slip" for name in SCENARIOS)
    return (MACHINE, *sorted((*SCENARIOS, *slipping)))


def load(name: str, folder: str | Path = FOLDER) -> Recording:
    """A drive from its files.

    Args:
        name: one of `names()`.
        folder: where the files are.

    Returns:
        Sensors and truth; turning and bias are NaN: the filter shall find them.

    Raises:
        ValueError: no drive of that name, or a file that is no log.
        FileNotFoundError: a file is not there.
    """
    if name not in names():
        raise ValueError(f"no drive {name!r}: there are {', '.join(names())}")
    encoders, imu, truth = (_read(path) for path in _paths(name, Path(folder)))
    if len(encoders) != len(imu) or (encoders[:, 0] != imu[:, 0]).any():
        raise ValueError(f"encoders and IMU of {name!r} have different times: {_COMMAND}")
    return Recording(
        name=name,
        time=encoders[:, 0],
        left=encoders[:, 1],
        right=encoders[:, 2],
        gyro=imu[:, 1],
        yaw=imu[:, 2],
        truth_time=truth[:, 0],
        truth=truth[:, 1:],
        turning=np.nan,
        bias=np.array(np.nan),
    )


def write(folder: str | Path = FOLDER) -> list[Path]:
    """Make all drives anew and write their files.

    Args:
        folder: where to; made if it is not there.

    Returns:
        The files.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    made = []
    for name in names():
        scenario = name.removesuffix("_slip")
        if name == MACHINE:
            drive, title = drive_the_machine(), "the simulated machine along its G, slip included"
        else:
            slips = name != scenario
            drive = record(scenario, turning=SLIPPING if slips else 1.0)
            title = SCENARIOS[scenario].title
        for kind, path in zip(_FILES, _paths(name, folder), strict=True):
            if path not in made:
                _save(path, kind, title, drive, name != scenario)
                made.append(path)
    return made


def _paths(name: str, folder: Path) -> tuple[Path, Path, Path]:
    scenario = name.removesuffix("_slip")
    whose = name, scenario, scenario
    return tuple(folder / f"{who}_{kind}.csv" for who, kind in zip(whose, _FILES, strict=True))


def _save(path: Path, kind: str, title: str, drive: Recording, slips: bool) -> None:
    header, form = _FILES[kind]
    if kind == "truth":
        stride = round(1 / TRUTH_RATE / (drive.time[1] - drive.time[0]))
        stride = max(stride, 1)
        table = np.column_stack([drive.truth_time, drive.truth])[::stride]
    elif kind == "imu":
        table = np.column_stack([drive.time, drive.gyro, drive.yaw])
    else:
        table = np.column_stack([drive.time, drive.left, drive.right])
    comments = [f"# {kind} of: {title}", f"# made by: {_COMMAND}"]
    if kind == "encoders":
        comments.append(f"# {_slip(drive, slips)}")
        comments.append(f"# seed {SEED}; noise of a sample: variance {NOISE.encoder} (rad/s)^2")
    elif kind == "imu":
        comments.append(
            f"# seed {SEED}; noise of a sample: variance {NOISE.gyro} (rad/s)^2 and {NOISE.yaw} "
            "rad^2; the gyro has a bias"
        )
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        file.write("\n".join([*comments, header]) + "\n")
        np.savetxt(file, np.round(table, 4) + 0.0, fmt=form)


def _slip(drive: Recording, slips: bool) -> str:
    if np.isnan(drive.turning):
        return "slip: that of the simulated tracks on the ground"
    if slips:
        return f"slip: the machine turns {drive.turning:g} of what its tracks would without slip"
    return "no slip"


def _read(path: Path) -> np.ndarray:
    if not path.is_file():
        raise FileNotFoundError(f"no file {path}: {_COMMAND} makes it")
    kind = path.stem.rsplit("_", 1)[1]
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = [line for line in lines if line and not line.startswith("#")]
    header = _FILES[kind][0]
    if not rows or rows[0] != header:
        raise ValueError(f"{path.name} must have the header {header!r}: {_COMMAND} makes it anew")
    return np.loadtxt(rows[1:], delimiter=",", ndmin=2)
