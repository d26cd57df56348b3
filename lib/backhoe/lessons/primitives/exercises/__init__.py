"""The exercises of lessons 10a, 10b and 10c, movement primitives."""

from backhoe.lessons.primitives.exercises import improvement, new_goals, primitives

__all__ = ["EXERCISES"]

EXERCISES = (*primitives.EXERCISES, *new_goals.EXERCISES, *improvement.EXERCISES)
