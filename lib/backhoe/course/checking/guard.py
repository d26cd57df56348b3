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
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from functools import partial

import numpy as np

_GRACE = 0.5  # [s] for a worker to end after an interruption

_interrupt = ctypes.PYFUNCTYPE(None, ctypes.c_ulong, ctypes.py_object)(
    ("PyThreadState_SetAsyncExc", ctypes.pythonapi)
)


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
        try:
            worker.start()
            worker.wait(seconds)
        finally:
            in_time = worker.over
            if not in_time:
                worker.end()
                worker.join(0.1)
    if not in_time:
        raise OutOfTime(stopped=worker.over)
    if worker.error is not None:
        raise worker.error
    return worker.result


class _Worker(threading.Thread):
    def __init__(self, job: Callable[[], object]) -> None:
        super().__init__(daemon=True)
        self.job, self.result, self.error = job, None, None
        self.over = self.interrupted = self.left_alone = False
        self.relentless = TimeUp

    def run(self) -> None:
        try:
            self.result = self.job()
        except BaseException as error:
            self.error = error
        self.relentless.__init__ = BaseException.__init__
        self.over = True
        while self.interrupted:
            try:
                time.sleep(1e-3)
                if self.left_alone:
                    break
            except TimeUp:
                pass

    def wait(self, seconds: float) -> None:
        """Wait until the job is over, for so long at most."""
        deadline = time.monotonic() + seconds
        while not self.over and time.monotonic() < deadline:
            self.join(0.01)

    def end(self) -> None:
        """Interrupt the job: politely, and if that does not help, relentlessly."""
        self.interrupted = True
        self.relentless = _relentless(self.ident)
        try:
            for interruption in (TimeUp, self.relentless):
                if self.ident and not self.over:
                    _interrupt(self.ident, interruption)
                self.wait(_GRACE)
        finally:
            self.left_alone = True


def _relentless(thread: int) -> type[TimeUp]:
    """An interruption that interrupts again whenever it is raised.

    `while True: try: ... except: pass` swallows one interruption, but not the next, which comes
    when the loop has not got back inside its `try` yet. Its `__init__` is compiled code: it would
    interrupt itself otherwise.
    """

    class Relentless(TimeUp):
        pass

    Relentless.__init__ = staticmethod(partial(_interrupt, thread, Relentless))
    return Relentless


class _Void(io.TextIOBase):
    """Discards what is printed, and knows whether anything was."""

    printed = False

    def write(self, text: str) -> int:
        self.printed = True
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
