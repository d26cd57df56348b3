"""Dynamic movement primitives: a demonstration as a spring, a phase and a learnt force."""
