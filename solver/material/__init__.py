"""Materials and composites: constants, admissibility, laws of composites, the built-in library."""
