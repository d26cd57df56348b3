"""Figures of lesson 08a."""
