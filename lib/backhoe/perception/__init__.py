"""What is around the machine: cameras and stereo, lasers, clouds and the maps made of them."""
