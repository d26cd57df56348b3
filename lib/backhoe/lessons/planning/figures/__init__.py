"""Figures, one module a sitting."""
