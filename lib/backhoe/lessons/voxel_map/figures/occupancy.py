"""Figures of lesson 09b."""
