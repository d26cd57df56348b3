"""The command `backhoe` and JupyterLab opened by it."""

import json
import os
import subprocess
import sys

import pytest

from backhoe import __main__, workspace


@pytest.fixture
def called(monkeypatch):
    """What would have been started instead of JupyterLab."""
    calls = []

    def call(command, env):
        calls.append((command, env))
        return 0

    monkeypatch.setattr(workspace.subprocess, "call", call)
    return calls


def test_lab_opens_the_tour_from_any_folder_and_passes_arguments_on(called, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert __main__.main(["lab", "--no-browser", "--port=9000"]) == 0
    ((command, _),) = called
    assert command[:3] == [sys.executable, "-m", "jupyterlab"]
    assert command[3] == str(workspace.root() / "notebooks" / "00_tour.ipynb")
    assert command[-2:] == ["--no-browser", "--port=9000"]


def test_lab_turns_announcements_off_and_keeps_the_students_settings(called, monkeypatch):
    monkeypatch.setenv("JUPYTER_CONFIG_PATH", "mine")
    __main__.main(["lab"])
    folders = called[0][1]["JUPYTER_CONFIG_PATH"].split(os.pathsep)
    assert folders[1] == "mine"
    with open(os.path.join(folders[0], "labconfig", "page_config.json"), encoding="utf-8") as file:
        disabled = json.load(file)["disabledExtensions"]
    assert disabled == {"@jupyterlab/apputils-extension:announcements": True}


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
