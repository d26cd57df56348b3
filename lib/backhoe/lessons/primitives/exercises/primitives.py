"""Exercises of sitting primitives."""

from backhoe.lessons.exercise import Exercise

__all__ = ["EXERCISES"]

EXERCISES: tuple[Exercise, ...] = ()
