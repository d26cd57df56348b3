"""Formulas of lessons 10a, 10b and 10c, movement primitives, as printed."""
