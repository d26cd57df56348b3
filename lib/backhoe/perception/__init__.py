"""What is around the machine: cameras and stereo, lasers, clouds and maps."""
