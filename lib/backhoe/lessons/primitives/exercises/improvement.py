"""Exercises of sitting improvement."""

from backhoe.lessons.exercise import Exercise

__all__ = ["EXERCISES"]

EXERCISES: tuple[Exercise, ...] = ()
