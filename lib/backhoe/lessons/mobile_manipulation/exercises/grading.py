"""Exercises of lesson 12b: manipulability, priorities, limits, the slope."""

EXERCISES = ()
