"""The exercises of lessons 08a and 08b, stereo: their references and the mistakes that they
recognise."""

from backhoe.lessons.stereo.exercises import camera, matching

__all__ = ["EXERCISES"]

EXERCISES = (*camera.EXERCISES, *matching.EXERCISES)
