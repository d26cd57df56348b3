"""What people see: figures that lessons share, the machine's looks, replays in 3D."""
