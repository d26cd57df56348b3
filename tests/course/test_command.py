"""The command `backhoe` and JupyterLab opened by it."""

import json
import os
import subprocess
import sys

import pytest
from jupyterlab.labapp import LabApp

from backhoe import __main__
from backhoe.course import workspace


@pytest.fixture
def started(monkeypatch):
    """The arguments with which JupyterLab would have been started."""
    arguments = []
    monkeypatch.setattr(LabApp, "launch_instance", arguments.extend)
    monkeypatch.setenv("JUPYTER_CONFIG_PATH", "mine")  # and put back what the command changes
    return arguments


def test_lab_opens_the_tour_from_any_folder_and_passes_arguments_on(started, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert __main__.main(["lab", "--folder", "mine", "--no-browser", "--port=9000"]) == 0
    assert started[:2] == [
        str(tmp_path / "mine" / "00_tour.ipynb"),
        f"--ServerApp.root_dir={tmp_path / 'mine'}",
    ]
    assert (tmp_path / "mine" / "00_tour.ipynb").exists()
    assert started[-2:] == ["--no-browser", "--port=9000"]


def test_lab_turns_announcements_off_and_keeps_the_students_settings(started, tmp_path):
    __main__.main(["lab", "--folder", str(tmp_path)])
    folders = os.environ["JUPYTER_CONFIG_PATH"].split(os.pathsep)
    assert folders[1] == "mine"
    with open(os.path.join(folders[0], "labconfig", "page_config.json"), encoding="utf-8") as file:
        disabled = json.load(file)["disabledExtensions"]
    assert disabled == {"@jupyterlab/apputils-extension:announcements": True}


def test_a_copy_that_cannot_be_written_is_told(started, capsys, tmp_path):
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    assert __main__.main(["lab", "--folder", str(tmp_path / "file")]) == 1
    assert "backhoe lab: " in capsys.readouterr().err and not started


def test_missing_jupyterlab_sends_to_the_doctor(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "jupyterlab.labapp", None)
    assert __main__.main(["lab"]) == 1
    assert "`backhoe doctor` says what to install" in capsys.readouterr().err


def test_unknown_command_and_argument_are_refused(capsys):
    for arguments in (["dig"], [], ["doctor", "--fast"]):
        with pytest.raises(SystemExit) as stopped:
            __main__.main(arguments)
        assert stopped.value.code == 2
    assert "--fast" in capsys.readouterr().err


def test_course_without_its_notebooks_says_how_to_install_it(monkeypatch, tmp_path):
    monkeypatch.setattr(workspace, "__file__", str(tmp_path / "a" / "b" / "workspace.py"))
    with pytest.raises(FileNotFoundError, match=r"pip install -r requirements\.txt"):
        workspace.root()


def test_command_and_module_are_the_same():
    usage = subprocess.run(
        [sys.executable, "-m", "backhoe", "--help"], capture_output=True, text=True, check=True
    ).stdout
    assert all(name in usage for name in ("lab", "doctor", "lessons"))
