"""The vehicle: tracks and wheels, their drives, speed control and the tracking of paths."""
