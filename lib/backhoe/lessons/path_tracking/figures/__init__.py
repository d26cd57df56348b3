"""Figures of lesson 05, a module a sitting and one of block diagrams."""
