"""The progress bar: seen while it runs, gone when it is stored."""

import subprocess
import sys

import pytest

from backhoe.basics.progress import progress_bar

CODE = """
from backhoe.basics.progress import progress_bar
with progress_bar(3, "simulations") as advance:
    for _ in range(3):
        advance(1)
print("done")
"""


def test_nothing_is_written_into_a_pipe():
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    assert done.stdout == "done\n"
    assert done.stderr == ""


def test_in_a_terminal_the_line_is_wiped(monkeypatch):
    written = []

    class Terminal:
        encoding = "utf-8"

        def write(self, text):
            written.append(text)

        def flush(self):
            pass

        def isatty(self):
            return True

    monkeypatch.setattr(sys, "stderr", Terminal())
    with progress_bar(2, "simulations") as advance:
        advance(2)
    assert any("2 simulations" in text or "/2" in text for text in written)
    assert "".join(written).rsplit("\r", 2)[-2].strip() == ""
    assert written[-1].endswith("\r")


def test_switched_off_it_shows_nothing(capfd):
    with progress_bar(2, "simulations", show=False) as advance:
        advance(2)
    assert capfd.readouterr() == ("", "")


def test_in_a_notebook_an_empty_line_is_left():
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(CODE)])
    updates = []

    class Client(nbclient.NotebookClient):
        def process_message(self, message, *rest):
            if message["msg_type"] == "update_display_data":
                updates.append(message["content"]["data"]["text/plain"])
            return super().process_message(message, *rest)

    Client(notebook, timeout=120, kernel_name="python3").execute()
    bar, text = notebook.cells[0].outputs
    assert bar.data == {"text/plain": ""}
    assert text.text == "done\n"
    assert any("0/3" in update for update in updates)
    assert updates[-1] == ""
