"""What serves lessons 08a and 08b, stereo."""
