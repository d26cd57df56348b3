"""Figures of sitting primitives."""
