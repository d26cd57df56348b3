"""Lesson 03, its sittings `03a` to `03c`: exercises, figures, printed formulas and bounds."""
