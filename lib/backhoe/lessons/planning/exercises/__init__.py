"""The exercises of lessons 11a and 11b, planning."""

from backhoe.lessons.planning.exercises import search, spilling

__all__ = ["EXERCISES"]

EXERCISES = (*search.EXERCISES, *spilling.EXERCISES)
