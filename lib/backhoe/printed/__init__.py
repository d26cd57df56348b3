"""Formulas as the sources print them, mistakes included: for study, never for the machine."""
