"""Lesson 01, `01_kinematics`: its exercises, figures and printed formulas."""
