"""Exercises of lesson 12a: the Jacobian, least velocities, the null space, W."""

EXERCISES = ()
