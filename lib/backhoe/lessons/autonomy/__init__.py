"""What serves lessons 14a and 14b, the machine alone."""
