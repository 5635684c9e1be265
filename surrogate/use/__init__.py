"""Uses of a surrogate: validation, sensitivity, inversion, learning from measured rows."""
