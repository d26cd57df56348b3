"""Figures of sitting spilling."""
