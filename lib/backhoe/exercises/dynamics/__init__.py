"""The exercises of lesson 02, dynamics: their references and the mistakes that they recognise."""

from backhoe.exercises.dynamics.gravity import BOOM_ALONE, GRAVITY, HOLD
from backhoe.exercises.dynamics.inertia import CORIOLIS, MASS_MATRIX, REPAIR
from backhoe.exercises.dynamics.reading import READING
from backhoe.exercises.dynamics.step import STEP

__all__ = ["EXERCISES"]

EXERCISES = (BOOM_ALONE, GRAVITY, MASS_MATRIX, CORIOLIS, HOLD, REPAIR, READING, STEP)
