"""Lessons 02a to 02c: their exercises, figures, bench and printed formulas."""
