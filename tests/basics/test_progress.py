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


CELLS = [
    "import backhoe, time",
    "from backhoe.basics import progress; progress.PATIENCE = progress.BEAT = 0.1",
    "print('at work'); time.sleep(0.6); print('done')",
    "1 + 1",
    "with progress.progress_bar(1, 'pieces') as advance:\n    time.sleep(0.6); advance(1)",
    "time.sleep(0.6); raise ValueError('as a student may')",
    "raise_no_more = 1",
]


@pytest.mark.parametrize("person", [True, False], ids=["a person", "a program"])
def test_a_long_cell_says_so_to_a_person(person):
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(code) for code in CELLS])
    words = {}

    class Client(nbclient.NotebookClient):
        async def async_start_new_kernel_client(self, *rest):
            client = await super().async_start_new_kernel_client(*rest)
            client.allow_stdin = person
            return client

        start_new_kernel_client = nbclient.util.run_sync(async_start_new_kernel_client)

        def process_message(self, message, cell, index):
            if message["msg_type"] == "update_display_data":
                words.setdefault(index, []).append(message["content"]["data"]["text/plain"])
            return super().process_message(message, cell, index)

    Client(notebook, timeout=120, kernel_name="python3", allow_errors=True).execute()
    outputs = [sorted({one.output_type for one in cell.outputs}) for cell in notebook.cells]
    if not person:
        assert list(words) == [4], "the bar with a number alone, as before"
        assert outputs[2:] == [["stream"], ["execute_result"], ["display_data"], ["error"], []]
        return
    assert sorted(words) == [2, 4, 5]
    for long in (2, 5):
        assert words[long][0] == "working, 0 s so far ..."
        assert words[long][-1] == "", "the line is wiped"
    assert not any("working" in word for word in words[4]), "one bar at a time"
    assert "".join(one.text for one in notebook.cells[2].outputs if "text" in one) == (
        "at work\ndone\n"
    )
    assert outputs[3] == ["execute_result"] and outputs[6] == []
