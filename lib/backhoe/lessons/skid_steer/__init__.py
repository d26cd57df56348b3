"""Lesson 04, `04_skid_steer`: its exercises, figures and printed formulas."""
