"""Lesson 06, `06_odometry`: its exercises, figures and printed formulas."""
