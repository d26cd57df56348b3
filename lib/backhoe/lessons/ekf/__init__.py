"""Chapter 07, `07a` to `07c`: its exercises, figures and printed formulas."""
