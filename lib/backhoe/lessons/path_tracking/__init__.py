"""What serves lessons 05a, 05b and 05c, path and trajectory tracking."""
