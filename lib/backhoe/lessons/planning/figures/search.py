"""Figures of sitting search."""
