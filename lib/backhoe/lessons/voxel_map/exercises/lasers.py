"""Exercises of lesson 09a."""

from __future__ import annotations

__all__ = ["EXERCISES"]

EXERCISES = ()
