"""Tracks and arm together: what holds for the whole machine.

- `stability`: what keeps it on its tracks, and how much of a load tips it over
"""
