"""Tools under everything, without robotics: checks of inputs, angles, poses in the plane, tiles."""
