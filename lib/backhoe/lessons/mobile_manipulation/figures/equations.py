"""Figures of lesson 12a."""
