"""Where to go: movements learnt from a demonstration, improved by practice, or searched for."""
