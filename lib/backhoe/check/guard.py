"""Run somebody else's code for a limited time, quietly, and survive whatever it does.

The code runs in a worker thread, on every system alike, while the caller waits. When time is up an
exception is raised inside the worker until it ends; a worker that cannot be ended (it waits in
compiled code, or swallows every exception) is left behind and the caller goes on. Real interrupts
reach the caller, because only the caller runs in the main thread. One limit remains: compiled
code that never lets go of the interpreter, such as `sum(range(10**12))`, stops the caller too.
"""

from __future__ import annotations

import ctypes
import io
import random
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout

import numpy as np

__all__ = ["OutOfTime", "TimeUp", "run"]

_GRACE = 1.0  # [s] for a worker to end after its time is up


class TimeUp(BaseException):
    """Raised inside the worker; not an Exception, so that `except Exception` lets it pass."""


class OutOfTime(Exception):
    """The time was up; `stopped` says whether the code could be ended."""

    def __init__(self, stopped: bool) -> None:
        super().__init__("time is up")
        self.stopped = stopped


def run(job: Callable[[], object], seconds: float) -> object:
    """Return what `job` returns, if it does so within `seconds`.

    What it prints and warns is discarded, and the global random states are put back.

    Raises:
        OutOfTime: `job` was not finished.
        BaseException: what `job` raised, a real KeyboardInterrupt included.
    """
    worker = _Worker(job)
    with _without_traces():
        worker.start()
        deadline = time.monotonic() + seconds
        try:
            while worker.is_alive() and time.monotonic() < deadline:
                worker.join(0.05)
        finally:
            in_time = worker.over
            if not in_time:
                worker.end()
    if not in_time:
        raise OutOfTime(stopped=worker.over)
    if worker.error is not None:
        raise worker.error
    return worker.result


class _Worker(threading.Thread):
    def __init__(self, job: Callable[[], object]) -> None:
        super().__init__(daemon=True)
        self.job, self.result, self.error, self.over = job, None, None, False

    def run(self) -> None:
        try:
            self.result = self.job()
        except TimeUp:
            pass
        except BaseException as error:
            self.error = error
        finally:
            self.over = True

    def end(self) -> None:
        """Interrupt until the job is over, in quick succession.

        A loop such as `while True: try: ... except: pass` survives an exception raised inside its
        `try`, but not the next one, if that comes before the loop is back inside.
        """
        switch_interval = sys.getswitchinterval()
        sys.setswitchinterval(1e-6)
        deadline = time.monotonic() + _GRACE
        try:
            while not self.over and time.monotonic() < deadline:
                ctypes.pythonapi.PyThreadState_SetAsyncExc(
                    ctypes.c_ulong(self.ident), ctypes.py_object(TimeUp)
                )
        finally:
            sys.setswitchinterval(switch_interval)


class _Void(io.TextIOBase):
    def write(self, text: str) -> int:
        return len(text)


@contextmanager
def _without_traces() -> Iterator[None]:
    numpy_state = np.random.get_state()  # noqa: NPY002 (the global state is what is protected)
    python_state = random.getstate()
    try:
        with (
            redirect_stdout(_Void()),
            redirect_stderr(_Void()),
            warnings.catch_warnings(),
        ):
            warnings.simplefilter("ignore")
            yield
    finally:
        np.random.set_state(numpy_state)  # noqa: NPY002
        random.setstate(python_state)
