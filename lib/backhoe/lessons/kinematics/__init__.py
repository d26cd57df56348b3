"""Lesson 01, `01a_frames` to `01c_steps`: its exercises, figures and printed formulas."""
