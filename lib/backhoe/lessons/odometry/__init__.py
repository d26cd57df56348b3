"""Lesson 06, `06a_sampling` to `06c_ground`: their exercises, figures, and formulas as printed."""
