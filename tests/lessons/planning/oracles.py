"""Independent answers to the exercises of lessons 11a and 11b, planning."""

from __future__ import annotations

# search

# spilling
