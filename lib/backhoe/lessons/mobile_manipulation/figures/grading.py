"""Figures of lesson 12b."""
