"""What was passed is remembered in the student's copy, and never in the way of a lesson."""

import json
import os
import subprocess
import sys
from types import SimpleNamespace

import pytest

from backhoe import __main__
from backhoe.course import catalogue
from backhoe.course.checking import Check, memory
from backhoe.course.workspace import RECORD

RIGHT, WRONG = 1234.0, 1.0


@pytest.fixture
def copy(tmp_path, monkeypatch):
    (tmp_path / RECORD).write_text("{}", encoding="utf-8")
    (tmp_path / "as_printed").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def right():
    return catalogue.find("0.1").reference()


def summary(capsys, folder=None):
    capsys.readouterr()
    Check(catalogue).summary(folder)
    return capsys.readouterr().out.splitlines()


def test_a_restarted_kernel_knows_what_was_passed_and_at_which_try(copy, right, capsys):
    first = Check(catalogue)
    for answer in (None, WRONG, WRONG, right, WRONG):
        first("0.1", answer)
    line = summary(capsys)[1]
    assert line.startswith("  0.1   right") and line.endswith(", try 3)")


def test_the_command_shows_it_too(copy, right, capsys):
    Check(catalogue)("0.1", right)
    capsys.readouterr()
    assert __main__.main(["progress", "--folder", str(copy)]) == 0
    assert "try 1)" in capsys.readouterr().out


def test_a_notebook_in_a_folder_of_the_copy_counts(copy, right, monkeypatch):
    monkeypatch.chdir(copy / "as_printed")
    Check(catalogue)("0.1", right)
    assert len(memory.recall(copy)[0]) == 1


def test_a_stub_does_not_undo_what_was_right(copy, right, capsys):
    Check(catalogue)("0.1", right)
    again = Check(catalogue)
    again("0.1", None)
    capsys.readouterr()
    again.summary()
    assert "  0.1   right" in capsys.readouterr().out


def test_outside_of_a_copy_nothing_is_written(tmp_path, right, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    check = Check(catalogue)
    check("0.1", right)
    assert not list(tmp_path.iterdir())
    capsys.readouterr()
    check.summary()
    assert "try 1)" in capsys.readouterr().out


def test_the_courses_own_notebooks_are_no_copy():
    assert memory.copy_around(workspace_of_the_course()) is None


def workspace_of_the_course():
    from backhoe.course.workspace import root

    return root() / "notebooks"


@pytest.mark.parametrize("broken", [b"{", b"[]\n", b'{"exercise": 1}\n', b"\xff\xfe\n", b"null\n"])
def test_a_damaged_file_is_set_aside_and_said_and_the_rest_stays(copy, right, capsys, broken):
    Check(catalogue)("0.1", right)
    file = copy / memory.FILE
    before = file.read_bytes() + broken
    file.write_bytes(before)
    Check(catalogue)("0.1", WRONG)  # after half a line
    lines = summary(capsys)
    assert lines[0] == f"the file of what was passed was damaged; it is now {memory.FILE}.damaged"
    assert "  0.1   right" in lines[2]
    assert (copy / f"{memory.FILE}.damaged").read_bytes().startswith(before)
    assert [one.right for one in memory.recall(copy)[0]] == [True, False]
    assert summary(capsys)[0].startswith("lesson 0")


def test_what_cannot_be_written_or_read_stops_no_check(copy, right, capsys, monkeypatch):
    (copy / memory.FILE).mkdir()  # nobody can write here, not even root
    check = Check(catalogue)
    check("0.1", right)
    assert capsys.readouterr().out.startswith("exercise 0.1: right")
    check.summary()
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("what was passed before cannot be read")
    assert "  0.1   right" in lines[2]


def test_a_folder_that_is_gone_stops_no_check(tmp_path, right, capsys, monkeypatch):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    Check(catalogue)("0.1", right)
    assert capsys.readouterr().out.startswith("exercise 0.1: right")


def test_a_full_disk_stops_no_check(copy, right, capsys, monkeypatch):
    def full(*arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "write", full)
    Check(catalogue)("0.1", right)
    assert capsys.readouterr().out.startswith("exercise 0.1: right")


KERNEL = """
import sys
from pathlib import Path
from backhoe.course.checking import memory
for _ in range(200):
    memory.remember(Path(sys.argv[1]), [memory.Checked.now(sys.argv[2], False)])
"""


def test_two_kernels_at_once_lose_nothing(copy):
    kernels = [
        subprocess.Popen([sys.executable, "-c", KERNEL, str(copy), name]) for name in ("0.1", "0.2")
    ]
    assert [one.wait() for one in kernels] == [0, 0]
    checks, said = memory.recall(copy)
    assert len(checks) == 400 and not said


def test_an_exercise_that_the_course_no_longer_has_is_passed_over(copy, capsys):
    memory.remember(copy, [memory.Checked.now("99.1", True), memory.Checked.now("0.99", True)])
    assert "lesson 0: 0 of" in summary(capsys)[0]


def test_what_a_check_prints_does_not_depend_on_what_is_remembered(copy, capsys):
    said = []
    for _ in range(2):
        check = Check(catalogue)
        for _ in range(4):
            check("0.1", WRONG)
        said.append(capsys.readouterr().out)
    assert said[0] == said[1]


def test_a_line_is_plain_json(copy, right):
    Check(catalogue)("0.1", right)
    (line,) = filter(None, (copy / memory.FILE).read_text(encoding="utf-8").splitlines())
    assert set(json.loads(line)) == {"exercise", "right", "when"}
    assert SimpleNamespace(**json.loads(line)).right is True
