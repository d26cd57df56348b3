"""Exercises of sitting new_goals."""

from backhoe.lessons.exercise import Exercise

__all__ = ["EXERCISES"]

EXERCISES: tuple[Exercise, ...] = ()
