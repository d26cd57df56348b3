"""`python -m backhoe.drives` writes the drives to `data/drives/`, or to another folder."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from backhoe.drives.files import FOLDER, write

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Write all drives; 0 when it is done.

    Args:
        arguments: what follows the command; the process's own if None.
    """
    parser = argparse.ArgumentParser(prog="python -m backhoe.drives", description=__doc__)
    parser.add_argument("--folder", default=FOLDER, help=f"where to (default: {FOLDER.name})")
    for path in write(parser.parse_args(arguments).folder):
        print(path.name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
