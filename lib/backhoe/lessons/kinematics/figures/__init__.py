"""Figures of lesson 01, a module a sitting."""
