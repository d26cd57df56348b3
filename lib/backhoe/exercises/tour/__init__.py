"""Exercises of lesson 00: first answers, about the machine's numbers and its four joints."""

from backhoe.exercises.tour.moving import MOVING
from backhoe.exercises.tour.reading import READING

__all__ = ["EXERCISES"]

EXERCISES = (*READING, *MOVING)
