"""Lesson 05, `05_path_tracking`: its exercises, figures and printed formulas."""
