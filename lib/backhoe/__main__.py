"""The command `backhoe`: open the lessons, show progress, check the machine, export pages."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code: 0 when all is well.

    Args:
        arguments: what follows `backhoe` on the command line; the process's own if None.
    """
    parser = argparse.ArgumentParser(prog="backhoe", description="The Backhoe robotics course.")
    commands = parser.add_subparsers(dest="command", required=True)
    lab = commands.add_parser(
        "lab", help="open JupyterLab on your own copy of the lessons; further arguments go to it"
    )
    lab.add_argument("--folder", help="of your copy (default: workspace, in the course)")
    progress = commands.add_parser("progress", help="show which exercises you have right, and when")
    progress.add_argument("--folder", help="of your copy (default: workspace, in the course)")
    commands.add_parser("doctor", help="check this machine and name the fix for what is missing")
    lessons = commands.add_parser("lessons", help="export pages that need no network")
    lessons.add_argument("--output", help="folder to make (default: build/lessons)")
    options, further = parser.parse_known_args(arguments)
    if further and options.command != "lab":
        parser.error(f"unrecognised arguments: {' '.join(further)}")

    try:
        return _run(options, further)
    except (ModuleNotFoundError, OSError, RuntimeError) as error:
        print(f"backhoe {options.command}: {error}", file=sys.stderr)
        return 1


def _run(options: argparse.Namespace, further: Sequence[str]) -> int:
    if options.command == "doctor":
        from backhoe.course import doctor

        return doctor.report(doctor.examine())
    if options.command == "lab":
        from backhoe.course import workspace

        workspace.open_lab(further, options.folder)
    elif options.command == "progress":
        from backhoe.course import check, workspace

        check.summary(workspace.default_folder() if options.folder is None else options.folder)
    else:
        from backhoe.course import site

        print(f"open {site.build(options.output) / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
