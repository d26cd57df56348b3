"""Lesson 02, `02_dynamics`: its exercises, figures and printed formulas."""
