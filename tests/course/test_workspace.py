"""The student's own copy: made without answers, brought up to date, and nothing of theirs lost."""

import json
import os
import shutil
import threading

import nbformat
import pytest

from backhoe.course import workspace

NAMES = ("00_tour.ipynb", "01_arm.ipynb", "as_printed/01_arm.ipynb")


def notebook(text, output="5\n"):
    cells = [nbformat.v4.new_markdown_cell("![the machine](../docs/machine.png)")]
    stored = [nbformat.v4.new_output("stream", text=output)]
    cells.append(nbformat.v4.new_code_cell(text, outputs=stored, execution_count=1))
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"
    return nbformat.writes(nbformat.v4.new_notebook(cells=cells))


@pytest.fixture
def course(tmp_path, monkeypatch):
    """A course of three notebooks, whose folder is the one that the library sees."""
    root = tmp_path / "course"
    for name in NAMES:
        path = root / "notebooks" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(notebook(f"print('{name}')"), encoding="utf-8")
    (root / "docs").mkdir()
    (root / "docs" / "machine.png").write_bytes(b"a picture")
    monkeypatch.setattr(workspace, "root", lambda: root)
    return root


@pytest.fixture
def copy(course):
    workspace.update()
    return course / "workspace"


def publish(course, name="01_arm.ipynb", text="print('newer')"):
    (course / "notebooks" / name).write_text(notebook(text), encoding="utf-8")


def edit(path, text="mine = 1"):
    one = nbformat.read(path, as_version=4)
    one.cells[1].source = text
    nbformat.write(one, path)
    return path.read_bytes()


def source(path):
    return nbformat.read(path, as_version=4).cells[1].source


def files(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def test_a_copy_has_all_lessons_without_outputs_and_their_pictures(course, copy):
    there = files(copy)
    assert set(there) == {*NAMES, "docs/machine.png", workspace.RECORD}
    for name in NAMES:
        one = nbformat.read(copy / name, as_version=4)
        nbformat.validate(one)
        assert one.cells[1].outputs == [] and one.cells[1].execution_count is None
        assert one.cells[0].source == "![the machine](docs/machine.png)"
        assert source(copy / name) == source(course / "notebooks" / name)


def test_the_course_itself_stays_as_it_is(course):
    before = files(course / "notebooks")
    workspace.update()
    assert files(course / "notebooks") == before


def test_a_second_update_does_and_says_nothing(course, copy):
    before = files(copy)
    assert workspace.update() == []
    assert files(copy) == before


def test_an_update_adds_what_is_new_and_replaces_what_nobody_touched(course, copy):
    publish(course)
    publish(course, "02_new.ipynb")
    assert workspace.update() == ["newer version: 01_arm.ipynb", "new: 02_new.ipynb"]
    assert source(copy / "01_arm.ipynb") == "print('newer')"


def test_an_edited_notebook_stays_and_the_newer_one_comes_beside_it_once(course, copy):
    mine = edit(copy / "01_arm.ipynb")
    assert workspace.update() == []
    publish(course)
    (said,) = workspace.update()
    assert said == "01_arm.ipynb is yours and stays; newer version: 01_arm.new.ipynb"
    assert (copy / "01_arm.ipynb").read_bytes() == mine
    assert source(copy / "01_arm.new.ipynb") == "print('newer')"
    assert workspace.update() == []


def test_a_newer_version_does_not_replace_the_one_beside_it_either(course, copy):
    edit(copy / "01_arm.ipynb")
    publish(course)
    workspace.update()
    mine = edit(copy / "01_arm.new.ipynb", "also = 'mine'")
    publish(course, text="print('newest')")
    workspace.update()
    assert (copy / "01_arm.new.ipynb").read_bytes() == mine
    assert source(copy / "01_arm.new2.ipynb") == "print('newest')"


def test_a_notebook_that_was_renamed_stays_and_a_fresh_one_comes(course, copy):
    mine = edit(copy / "01_arm.ipynb")
    (copy / "01_arm.ipynb").rename(copy / "my arm.ipynb")
    assert workspace.update() == ["new: 01_arm.ipynb"]
    assert (copy / "my arm.ipynb").read_bytes() == mine


def test_a_damaged_record_is_set_aside_and_costs_nobody_anything(course, copy):
    mine = edit(copy / "01_arm.ipynb")
    for broken in ("{", "[]", '{"a": 1}', ""):
        (copy / workspace.RECORD).write_text(broken, encoding="utf-8")
        said = workspace.update()
        assert said[0] == (
            "the list of what was copied was damaged; it is now .backhoe.json.damaged"
        )
        assert (copy / f"{workspace.RECORD}.damaged").read_text(encoding="utf-8") == broken
        assert (copy / "01_arm.ipynb").read_bytes() == mine
    assert set(json.loads((copy / workspace.RECORD).read_bytes())) == {*NAMES, "docs/machine.png"}


@pytest.mark.parametrize("writes", range(10))
def test_a_power_cut_at_any_write_leaves_whole_files_and_the_next_update_ends_it(
    course, copy, monkeypatch, writes
):
    mine = edit(copy / "00_tour.ipynb")
    for name in NAMES:
        publish(course, name)
    before, whole, left = files(copy), workspace._write, [writes]

    def until_the_cut(place, content):
        if not left[0]:
            raise OSError(28, "No space left on device")
        left[0] -= 1
        whole(place, content)

    monkeypatch.setattr(workspace, "_write", until_the_cut)
    try:
        workspace.update()
    except OSError:
        pass
    monkeypatch.setattr(workspace, "_write", whole)
    for name in NAMES:
        assert source(copy / name) in (source_of(before[name]), "print('newer')")
    workspace.update()
    assert (copy / "00_tour.ipynb").read_bytes() == mine
    assert source(copy / "00_tour.new.ipynb") == "print('newer')"
    assert [source(copy / name) for name in NAMES[1:]] == ["print('newer')"] * 2
    assert workspace.update() == []
    assert not list(copy.rglob(".0*"))


def source_of(content):
    return nbformat.reads(content.decode(), as_version=4).cells[1].source


def test_a_full_disk_leaves_what_was_there(course, copy, monkeypatch):
    before = files(copy)
    publish(course)

    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        workspace.update()
    assert files(copy) == before


def test_a_read_only_folder_leaves_what_was_there_and_is_said(course, copy, monkeypatch):
    before = files(copy)
    publish(course)
    (course / "notebooks" / "00_tour.ipynb").unlink()

    def refuse(*arguments, **keywords):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(workspace.Path, "replace", refuse)
    with pytest.raises(PermissionError):
        workspace.update()
    monkeypatch.undo()
    assert files(copy) == before


def test_two_updates_at_once_end_like_one(course, copy):
    mine = edit(copy / "00_tour.ipynb")
    for name in NAMES:
        publish(course, name, "print('newer')\n" * 2000)
    split(course)
    folder, failed = course / "workspace", []

    def run():
        try:
            workspace.update(folder)
        except Exception as error:
            failed.append(error)

    updates = [threading.Thread(target=run) for _ in range(6)]
    for one in updates:
        one.start()
    for one in updates:
        one.join()
    assert not failed
    assert (copy / "00_tour.ipynb").read_bytes() == mine
    assert source(copy / "00_tour.new.ipynb") == ("print('newer')\n" * 2000)
    assert workspace.update() == []
    assert set(files(copy)) == {
        *("00_tour.ipynb", "00_tour.new.ipynb", "as_printed/01_arm.ipynb", "docs/machine.png"),
        *("01a_frames.ipynb", "01b_inverse.ipynb", "old/01_arm.ipynb", workspace.RECORD),
    }


def split(course):
    """The course has a chapter in two sittings now."""
    (course / "notebooks" / "01_arm.ipynb").unlink()
    publish(course, "01a_frames.ipynb")
    publish(course, "01b_inverse.ipynb")


def test_an_untouched_notebook_that_the_course_no_longer_has_is_put_aside(course, copy):
    before = (copy / "01_arm.ipynb").read_bytes()
    split(course)
    assert workspace.update() == [
        "01_arm.ipynb is no longer in the course; it is now old/01_arm.ipynb",
        "new: 01a_frames.ipynb",
        "new: 01b_inverse.ipynb",
    ]
    assert (copy / "old" / "01_arm.ipynb").read_bytes() == before
    assert not (copy / "01_arm.ipynb").exists() and workspace.update() == []


def test_an_edited_notebook_that_the_course_no_longer_has_stays(course, copy):
    mine = edit(copy / "01_arm.ipynb")
    split(course)
    said = workspace.update()
    assert said[0] == (
        "01_arm.ipynb is yours and stays; the course has no notebook of that name any more"
    )
    assert (copy / "01_arm.ipynb").read_bytes() == mine and workspace.update() == []


def test_what_is_put_aside_replaces_nothing_there(course, copy):
    (copy / "old").mkdir()
    (copy / "old" / "01_arm.ipynb").write_bytes(b"mine")
    split(course)
    assert workspace.update()[0].endswith("it is now old/01_arm.new.ipynb")
    assert (copy / "old" / "01_arm.ipynb").read_bytes() == b"mine"


def test_a_lesson_that_was_deleted_by_the_student_and_the_course_is_not_missed(course, copy):
    (copy / "01_arm.ipynb").unlink()
    split(course)
    assert workspace.update() == ["new: 01a_frames.ipynb", "new: 01b_inverse.ipynb"]


def test_an_older_courses_copy_without_a_record_keeps_all(course, copy):
    (copy / workspace.RECORD).unlink()
    mine = edit(copy / "00_tour.ipynb")
    before = files(copy)
    split(course)
    workspace.update()
    assert {name: files(copy)[name] for name in before} == before
    assert (copy / "00_tour.ipynb").read_bytes() == mine


def test_where_the_course_cannot_be_written_the_copy_is_in_the_home_folder(course, monkeypatch):
    home = course.parent / "home"
    monkeypatch.setattr(workspace.Path, "home", lambda: home)
    assert workspace.default_folder() == course / "workspace"
    monkeypatch.setattr(os, "access", lambda path, mode: not str(path).startswith(str(course)))
    assert workspace.default_folder() == home / workspace.HOME
    workspace.update()
    assert (home / workspace.HOME / "00_tour.ipynb").exists()


def test_a_copy_in_any_folder(course, tmp_path):
    workspace.update(tmp_path / "a b" / "mine")
    assert (tmp_path / "a b" / "mine" / "as_printed" / "01_arm.ipynb").exists()


def test_the_real_lessons_run_from_their_copy(tmp_path):
    workspace.update(tmp_path)
    names = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.ipynb")}
    notebooks = workspace.root() / "notebooks"
    assert names == {p.relative_to(notebooks).as_posix() for p in notebooks.rglob("[0-9]*.ipynb")}
    shutil.rmtree(tmp_path)
