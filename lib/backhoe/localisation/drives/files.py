"""The drives as CSV in `data/drives/`: encoders, IMU and the truth, each in a file of its own.

Comments (#) say what it is, with which seed and noise, and the command that makes it; then comes a
header with units. The yaw is printed as it is, not wrapped.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from backhoe.basics.inputs import choice
from backhoe.localisation import drive_log
from backhoe.localisation.drive_log import DriveLog
from backhoe.localisation.drives.recording import NOISE, SEED, Recording
from backhoe.localisation.drives.scenarios import SCENARIOS
from backhoe.machine import BACKHOE, Machine

FOLDER = Path(__file__).resolve().parents[4] / "data" / "drives"

TRUTH_RATE = 20.0
"""Of the truth in the files [Hz], or the nearest that the samples allow: a log of its own."""

MACHINE = "backhoe"
"""The drive of the machine itself."""

_COMMAND = "python -m backhoe.mission.write_drives"
_COLUMNS = ("left_rate", "right_rate"), ("gyro", "yaw"), ("x", "y", "psi")
_FILES = {
    "encoders": ("t [s],left_rate [rad/s],right_rate [rad/s]", "%.2f,%.3f,%.3f", 3),
    "imu": ("t [s],gyro [rad/s],yaw [rad]", "%.2f,%.3f,%.3f", 3),
    "truth": ("t [s],x [m],y [m],psi [rad]", "%.2f,%.4f,%.4f,%.4f", 4),
}


def names() -> tuple[str, ...]:
    """Names of the drives that `load` accepts."""
    slipping = tuple(f"{name}_slip" for name in SCENARIOS)
    return (MACHINE, *sorted((*SCENARIOS, *slipping)))


def load(name: str, folder: str | Path | None = None) -> Recording:
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
    choice(name, "name", names())
    encoders, imu, truth = (
        _read(path, columns)
        for path, columns in zip(_paths(name, Path(folder or FOLDER)), _COLUMNS, strict=True)
    )
    return from_log(encoders, imu, truth, name=name)


def from_log(
    encoders: DriveLog,
    imu: DriveLog | None = None,
    truth: DriveLog | None = None,
    *,
    name: str = "a log",
    machine: Machine = BACKHOE,
) -> Recording:
    """A recording from logs, your own for instance, as `drive_log.read` gives them.

    Args:
        encoders: with left_rate, right_rate [rad/s], or left, right as angles [rad].
        imu: with gyro [rad/s], yaw [rad] or both, at the times of the encoders; default what the
            encoders' log has of them. What is missing is NaN.
        truth: with x, y, psi; default what the encoders' log has, else the origin at the start.
        name: of the drive.
        machine: whose gauge and sprockets these are.

    Returns:
        The recording; turning and bias are NaN: a filter shall find them.

    Raises:
        ValueError: no encoders in the log, or an IMU with other times.
    """
    imu = encoders if imu is None else imu
    if len(encoders) != len(imu) or (encoders.time != imu.time).any():
        raise ValueError(f"encoders and IMU of {name!r} must have the same times")
    truth = encoders if truth is None else truth
    known = all(column in truth for column in ("x", "y", "psi"))
    missing = np.full(len(imu), np.nan)
    left, right = _rates(encoders, name)
    return Recording(
        name=name,
        time=encoders.time,
        left=left,
        right=right,
        gyro=imu["gyro"] if "gyro" in imu else missing,
        yaw=imu["yaw"] if "yaw" in imu else missing,
        truth_time=truth.time if known else encoders.time[:1],
        truth=truth.pose if known else np.zeros((1, 3)),
        turning=np.nan,
        bias=np.array(np.nan),
        machine=machine,
    )


def _rates(log: DriveLog, name: str) -> tuple[np.ndarray, np.ndarray]:
    if "left_rate" in log and "right_rate" in log:
        return log["left_rate"], log["right_rate"]
    if "left" in log and "right" in log:
        sides = (np.diff(angles) / np.diff(log.time) for angles in log.angles())
        left, right = (np.concatenate([side[:1], side]) for side in sides)
        return left, right
    raise ValueError(
        f"the log of {name!r} must have left_rate and right_rate [rad/s], or left and right [rad], "
        f"got {', '.join(log.columns)}"
    )


def _paths(name: str, folder: Path) -> tuple[Path, Path, Path]:
    scenario = name.removesuffix("_slip")
    whose = name, scenario, scenario
    return tuple(folder / f"{who}_{kind}.csv" for who, kind in zip(whose, _FILES, strict=True))


def save(name: str, title: str, drive: Recording, folder: str | Path | None = None) -> list[Path]:
    """Write a drive's three files, but those of a scenario that are there for its other name.

    Args:
        name: one of `names()`.
        title: what the files say that it is.
        drive: sensors and truth.
        folder: where to; made if it is not there.

    Returns:
        The files written; a drive with slip shares the IMU and the truth of the one without.
    """
    folder = Path(folder or FOLDER)
    folder.mkdir(parents=True, exist_ok=True)
    shares = name.endswith("_slip")
    written = list(zip(_FILES, _paths(name, folder), strict=True))[: 1 if shares else None]
    for kind, path in written:
        _save(path, kind, title, drive)
    return [path for _, path in written]


def _save(path: Path, kind: str, title: str, drive: Recording) -> None:
    header, form, decimals = _FILES[kind]
    tables = {
        "encoders": (drive.time, drive.left, drive.right),
        "imu": (drive.time, drive.gyro, drive.yaw),
        "truth": (drive.truth_time, *drive.truth.T),
    }
    table = np.column_stack(tables[kind])
    if kind == "truth":
        table = table[:: round(1 / TRUTH_RATE / (drive.time[1] - drive.time[0]))]
    lines = [f"{kind} of: {title}", f"made by: {_COMMAND}", *_remarks(kind, drive)]
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        file.write("".join(f"# {line}\n" for line in lines) + header + "\n")
        np.savetxt(file, np.round(table, decimals) + 0.0, fmt=form)


def _remarks(kind: str, drive: Recording) -> list[str]:
    sample = f"seed {SEED}; noise of a sample: variance"
    if kind == "encoders":
        return [_slip(drive.turning), f"{sample} {NOISE.encoder} (rad/s)^2"]
    if kind == "imu":
        return [f"{sample} {NOISE.gyro} (rad/s)^2 and {NOISE.yaw} rad^2; the gyro has a bias"]
    return []


def _slip(turning: float) -> str:
    if np.isnan(turning):
        return "slip: that of the simulated tracks on the ground"
    if turning == 1:
        return "no slip"
    return f"slip: the machine turns {turning:g} of what its tracks would without slip"


def _read(path: Path, columns: tuple[str, ...]) -> DriveLog:
    if not path.is_file():
        raise FileNotFoundError(f"no file {path}: {_COMMAND} makes it")
    return drive_log.read(path, require=columns)
