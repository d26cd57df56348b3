"""Exercises of sitting search."""

from backhoe.lessons.exercise import Exercise

__all__ = ["EXERCISES"]

EXERCISES: tuple[Exercise, ...] = ()
