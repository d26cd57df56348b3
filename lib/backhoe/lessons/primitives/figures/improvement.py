"""Figures of sitting improvement."""
