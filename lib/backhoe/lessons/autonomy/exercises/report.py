"""Exercises of sitting report."""

from backhoe.lessons.exercise import Exercise

__all__ = ["EXERCISES"]

EXERCISES: tuple[Exercise, ...] = ()
