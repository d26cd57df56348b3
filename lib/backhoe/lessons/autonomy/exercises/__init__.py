"""The exercises of lessons 14a and 14b, the machine alone."""

from backhoe.lessons.autonomy.exercises import decisions, report

__all__ = ["EXERCISES"]

EXERCISES = (*decisions.EXERCISES, *report.EXERCISES)
