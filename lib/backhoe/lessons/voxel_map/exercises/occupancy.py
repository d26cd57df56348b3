"""Exercises of lesson 09b."""

from __future__ import annotations

__all__ = ["EXERCISES"]

EXERCISES = ()
