"""The whole mission alone: look, choose, dig, load, until the truck is full."""
