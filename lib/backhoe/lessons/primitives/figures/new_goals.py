"""Figures of sitting new_goals."""
