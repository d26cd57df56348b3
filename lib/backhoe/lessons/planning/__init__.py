"""What serves lessons 11a and 11b, planning."""
