"""Exercises of lesson 08a."""

from __future__ import annotations

__all__ = ["EXERCISES"]

EXERCISES = ()
