"""Figures of lesson 09c."""
