"""What the slides of Sasig and Chicaiza 2017 print. Not for use."""
