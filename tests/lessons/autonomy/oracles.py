"""Independent answers to the exercises of lessons 14a and 14b, the machine alone."""

from __future__ import annotations

# decisions

# report
