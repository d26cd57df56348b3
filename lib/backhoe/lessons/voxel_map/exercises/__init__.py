"""The exercises of lessons 09a to 09c, the voxel map: their references and the mistakes that they
recognise."""

from backhoe.lessons.voxel_map.exercises import lasers, occupancy, terrain

__all__ = ["EXERCISES"]

EXERCISES = (*lasers.EXERCISES, *occupancy.EXERCISES, *terrain.EXERCISES)
