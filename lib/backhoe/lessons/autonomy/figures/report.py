"""Figures of sitting report."""
