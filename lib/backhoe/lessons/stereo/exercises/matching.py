"""Exercises of lesson 08b."""

from __future__ import annotations

__all__ = ["EXERCISES"]

EXERCISES = ()
