"""The course around the lessons: `check` for answers, the doctor, the pages, the workspace."""

from __future__ import annotations

__all__ = ["check"]


def __getattr__(name: str) -> object:
    """`check`, made when first asked for: the doctor must start where nothing is installed."""
    if name != "check":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from backhoe.course import catalogue
    from backhoe.course.checking import Check

    globals()["check"] = Check(catalogue)
    return globals()["check"]
