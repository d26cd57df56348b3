"""Lessons 04a to 04c: their exercises, figures and printed formulas."""
