"""What serves lessons 12a and 12b, mobile manipulation."""
