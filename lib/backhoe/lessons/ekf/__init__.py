"""Lesson 07, `07_ekf`: its exercises, figures and printed formulas."""
