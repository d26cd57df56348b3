"""Exercises of lesson 00: first answers, about the machine's numbers and its four joints."""

from backhoe.lessons.tour.exercises.moving import MOVING
from backhoe.lessons.tour.exercises.reading import READING

__all__ = ["EXERCISES"]

EXERCISES = (*READING, *MOVING)
