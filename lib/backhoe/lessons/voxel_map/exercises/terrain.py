"""Exercises of lesson 09c."""

from __future__ import annotations

__all__ = ["EXERCISES"]

EXERCISES = ()
