"""Tests marked `alone` run while all others wait: the time that they measure is then their own."""

from contextlib import ExitStack, contextmanager

import pytest

try:
    import fcntl
except ImportError:  # Windows: nothing holds the others back
    fcntl = None


@contextmanager
def _locked(file, kind):
    with open(file, "w") as handle:
        fcntl.flock(handle, kind)
        yield


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item):
    if fcntl is None or not hasattr(item.config, "cache"):
        return (yield)
    locks = item.config.cache.mkdir("alone")
    kind = fcntl.LOCK_EX if item.get_closest_marker("alone") else fcntl.LOCK_SH
    with ExitStack() as room:
        # Whoever waits for an empty room holds the door, so that nobody slips in before.
        with _locked(locks / "door", fcntl.LOCK_EX):
            room.enter_context(_locked(locks / "room", kind))
        return (yield)
