"""Materials and composites: constants, admissibility, the built-in library."""
