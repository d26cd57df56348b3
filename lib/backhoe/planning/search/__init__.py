"""Ways around obstacles: on grids, in the plane and for the arm."""
