"""Figures of lesson 09a."""
