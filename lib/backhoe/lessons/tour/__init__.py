"""Lesson 00, `00_tour`: its exercises, figures and printed formulas."""
