"""The exercises of lessons 12a and 12b, tracks and arm together: their references and the mistakes
that they recognise."""

from backhoe.lessons.mobile_manipulation.exercises import equations, grading

__all__ = ["EXERCISES"]

EXERCISES = (*equations.EXERCISES, *grading.EXERCISES)
