"""A progress bar that leaves nothing behind: no output that changes from run to run is stored.

In a terminal it is a line that is wiped at the end; in a notebook, one line of output that is empty
again at the end; into a file or a pipe nothing is written. A cell that takes long without a bar of
its own says for how long it has been working, where a person sits at the notebook.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

__all__ = ["progress_bar", "watch_cells"]

PATIENCE = 2.0
"""How long a cell may work without a word [s]."""
BEAT = 1.0
"""Time between two words [s]."""


@contextmanager
def progress_bar(total: int, unit: str, show: bool = True) -> Iterator[Callable[[int], object]]:
    """Show how far a job is.

    Args:
        total: how many pieces the job has.
        unit: what they are, such as "simulations".
        show: False for no bar.

    Yields:
        A function to call with the number of pieces done since the last call.
    """
    if not show:
        yield lambda pieces: None
        return
    from tqdm import tqdm

    line = _NotebookLine() if _in_notebook() else None
    _bars.append(line)
    try:
        with tqdm(
            total=total, unit=f" {unit}", leave=False, file=line, disable=_hidden(line)
        ) as bar:
            yield bar.update
    finally:
        _bars.remove(line)


_bars: list[_NotebookLine | None] = []
"""Bars that are open: a cell that shows one says no more."""


def watch_cells() -> None:
    """Let each cell of this notebook that works for long say so; a second call does nothing.

    The line is there only while the cell works. It is shown to people alone: a program that runs
    a notebook tells the kernel that nobody can answer a question, so nothing is stored by it.
    """
    if not _in_notebook():
        return
    from IPython import get_ipython

    shell = get_ipython()
    if getattr(shell, "_backhoe_watch", None) is None:
        shell._backhoe_watch = watch = _Watch(shell)
        shell.events.register("pre_run_cell", watch.begin)
        shell.events.register("post_run_cell", watch.end)
        watch.begin()


class _Watch:
    """A clock beside the running cell.

    Args:
        shell: of the notebook.
    """

    def __init__(self, shell: object) -> None:
        self._shell = shell
        self._done, self._clock = threading.Event(), None

    def begin(self, info: object = None) -> None:
        """A cell starts; or the library is loaded by one that has started."""
        self.end()
        if self._shell.kernel.get_parent("shell").get("content", {}).get("allow_stdin"):
            self._done = threading.Event()
            clock = threading.Thread(target=self._run, args=(self._done,), daemon=True)
            with suppress(RuntimeError):  # where no thread can start, a cell works in silence
                clock.start()
                self._clock = clock

    def end(self, result: object = None) -> None:
        """The cell is done: wait until its line is empty."""
        self._done.set()
        if self._clock is not None:
            self._clock.join()
            self._clock = None

    @staticmethod
    def _run(done: threading.Event) -> None:
        start, line = time.monotonic(), None
        wait = PATIENCE
        while not done.wait(wait):
            wait = BEAT
            if not _bars:
                line = line or _NotebookLine()
                line.write(f"working, {time.monotonic() - start:.0f} s so far ...")
            elif line:
                line.write("")
        if line:
            line.write("")


def _hidden(line: _NotebookLine | None) -> bool | None:
    """False to show the bar, None to let tqdm show it in a terminal alone."""
    return None if line is None else False


def _in_notebook() -> bool:
    if "IPython" not in sys.modules:
        return False
    from IPython import get_ipython

    return hasattr(get_ipython(), "kernel")


class _NotebookLine:
    """A stream whose last line is shown in a notebook's output, in place of the one before."""

    def __init__(self) -> None:
        from IPython.display import display

        self._shown = display({"text/plain": ""}, raw=True, display_id=True)

    def write(self, text: str) -> None:
        self._shown.update({"text/plain": text.strip()}, raw=True)

    def flush(self) -> None:
        """Nothing is held back."""
