"""Independent answers to the exercises of lessons 10a, 10b and 10c, movement primitives."""

from __future__ import annotations

# primitives

# new_goals

# improvement
