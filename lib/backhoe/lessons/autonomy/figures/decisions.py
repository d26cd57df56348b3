"""Figures of sitting decisions."""
