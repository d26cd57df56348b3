"""Where the course lies on this machine, and JupyterLab opened on it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

__all__ = ["open_lab", "root"]


def root() -> Path:
    """The course's folder: the one with `notebooks/`, `lib/` and `requirements.txt`.

    Raises:
        FileNotFoundError: this library was installed without the course around it.
    """
    folder = Path(__file__).resolve().parents[2]
    if not (folder / "notebooks").is_dir():
        raise FileNotFoundError(
            f"no notebooks beside {folder}: install the course from its own folder with "
            "`pip install -r requirements.txt`"
        )
    return folder


def open_lab(arguments: Sequence[str] = ()) -> int:
    """Open JupyterLab on the tour and return its exit code when it ends.

    Args:
        arguments: passed on to JupyterLab, such as `--no-browser`.
    """
    settings = str(Path(__file__).with_name("jupyter"))  # no news, no question about them
    paths = [settings, *filter(None, [os.environ.get("JUPYTER_CONFIG_PATH")])]
    tour = root() / "notebooks" / "00_tour.ipynb"
    command = [sys.executable, "-m", "jupyterlab", str(tour), f"--ServerApp.root_dir={root()}"]
    return subprocess.call(
        [*command, *arguments],
        env={**os.environ, "JUPYTER_CONFIG_PATH": os.pathsep.join(paths)},
    )
