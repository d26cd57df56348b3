"""`python -m backhoe.mission.write_drives` writes the drives to `data/drives/`, or elsewhere."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from backhoe.localisation.drives import SCENARIOS, SLIPPING, Recording, record, save
from backhoe.localisation.drives.files import FOLDER, MACHINE, names
from backhoe.mission.recorded import drive_the_machine


def write(folder: str | Path | None = None) -> list[Path]:
    """Make all drives anew and write their files.

    Args:
        folder: where to; made if it is not there.

    Returns:
        The files.
    """
    return [path for name in names() for path in save(name, *_drive(name), folder)]


def _drive(name: str) -> tuple[str, Recording]:
    if name == MACHINE:
        return "the simulated machine along a G with the slip of its tracks", drive_the_machine()
    scenario = name.removesuffix("_slip")
    drive = record(scenario, turning=1.0 if name == scenario else SLIPPING)
    return SCENARIOS[scenario].title, drive


def main(arguments: Sequence[str] | None = None) -> int:
    """Write all drives; 0 when it is done.

    Args:
        arguments: what follows the command; the process's own if None.
    """
    parser = argparse.ArgumentParser(
        prog="python -m backhoe.mission.write_drives", description=__doc__
    )
    parser.add_argument("--folder", default=FOLDER, help=f"where to (default: {FOLDER.name})")
    for path in write(parser.parse_args(arguments).folder):
        print(path.name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
