"""What decides each verdict on the slides of Sasig and Chicaiza: properties, printed forms."""
