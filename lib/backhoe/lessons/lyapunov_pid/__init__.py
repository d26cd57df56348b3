"""Lesson 03, `03_lyapunov_pid`: its exercises, figures and printed formulas."""
