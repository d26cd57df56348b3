"""`backhoe lessons`: every notebook as a page that opens in any browser, without a network."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from backhoe.course.workspace import root

_PACKAGES = {"sphinx": "sphinx", "myst_nb": "myst-nb", "furo": "furo"}
_MARK = ".buildinfo"  # what Sphinx leaves in a folder that it made


def build(output: str | Path | None = None) -> Path:
    """Export the notebooks as they are stored, without running them, and return the folder.

    Args:
        output: the folder to make, `build/lessons` in the course if None. An earlier export there
            is replaced.

    Raises:
        ModuleNotFoundError: Sphinx, myst-nb or furo are missing; the message says how to get them.
        FileExistsError: `output` holds something else than an earlier export.
        RuntimeError: a page could not be made, or a link in it leads nowhere.
    """
    missing = [name for module, name in _PACKAGES.items() if not importlib.util.find_spec(module)]
    if missing:
        raise ModuleNotFoundError(
            f"the export needs {', '.join(missing)}; install with: "
            f'"{sys.executable}" -m pip install -r "{root() / "requirements-dev.txt"}"'
        )
    output = Path(output) if output else root() / "build" / "lessons"
    if output.exists() and any(output.iterdir()) and not (output / _MARK).exists():
        raise FileExistsError(f"{output} holds other files; name an empty or a new folder")
    with TemporaryDirectory() as place:
        pages = Path(place, "pages")
        command = [sys.executable, "-m", "sphinx", "--builder", "html", "--quiet"]
        command += ["--fail-on-warning", "--keep-going", "--doctree-dir", str(Path(place, "trees"))]
        done = subprocess.run(
            [*command, str(root() / "notebooks"), str(pages)],
            capture_output=True,
            text=True,
            env={**os.environ, "PYTHONWARNINGS": "ignore"},
            check=False,
        )
        if done.returncode:
            raise RuntimeError(f"the export stopped:\n{done.stdout}{done.stderr}")
        if output.exists():
            shutil.rmtree(output)
        output.parent.mkdir(parents=True, exist_ok=True)
        shutil.copytree(pages, output)
    return output
