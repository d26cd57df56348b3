"""What serves lessons 09a, 09b and 09c, the voxel map."""
