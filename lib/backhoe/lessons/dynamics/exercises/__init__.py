"""The exercises of lesson 02, dynamics: their references and the mistakes that they recognise."""

from backhoe.lessons.dynamics.exercises.gravity import BOOM_ALONE, GRAVITY, HOLD
from backhoe.lessons.dynamics.exercises.inertia import CORIOLIS, MASS_MATRIX, REPAIR
from backhoe.lessons.dynamics.exercises.reading import READING
from backhoe.lessons.dynamics.exercises.standing import TIPS
from backhoe.lessons.dynamics.exercises.step import STEP

__all__ = ["EXERCISES"]

EXERCISES = (BOOM_ALONE, GRAVITY, MASS_MATRIX, CORIOLIS, HOLD, REPAIR, READING, STEP, TIPS)
