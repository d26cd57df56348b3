"""Where the course lies on this machine, and JupyterLab opened on it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path


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


def open_lab(arguments: Sequence[str] = ()) -> None:
    """Open JupyterLab on the tour; it runs until it is stopped.

    Args:
        arguments: passed on to JupyterLab, such as `--no-browser`.

    Raises:
        ModuleNotFoundError: JupyterLab is not installed.
        FileNotFoundError: the notebooks are not beside the library.
    """
    try:
        from jupyterlab.labapp import LabApp
    except ModuleNotFoundError as error:
        fix = "`backhoe doctor` says what to install"
        raise ModuleNotFoundError(f"JupyterLab is missing ({error}); {fix}") from error

    settings = str(Path(__file__).with_name("jupyter"))  # no news, no question about them
    paths = [settings, *filter(None, [os.environ.get("JUPYTER_CONFIG_PATH")])]
    os.environ["JUPYTER_CONFIG_PATH"] = os.pathsep.join(paths)
    tour = root() / "notebooks" / "00_tour.ipynb"
    LabApp.launch_instance([str(tour), f"--ServerApp.root_dir={root()}", *arguments])
