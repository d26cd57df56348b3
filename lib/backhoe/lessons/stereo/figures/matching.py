"""Figures of lesson 08b."""
