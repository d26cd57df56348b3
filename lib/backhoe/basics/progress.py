"""A progress bar that leaves nothing behind: no output that changes from run to run is stored.

In a terminal it is a line that is wiped at the end; in a notebook, one line of output that is empty
again at the end; into a file or a pipe nothing is written.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

__all__ = ["progress_bar"]


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
    with tqdm(total=total, unit=f" {unit}", leave=False, file=line, disable=_hidden(line)) as bar:
        yield bar.update


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
