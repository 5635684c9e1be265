"""How many levels a factorial needs along each factor, from the decay of its coefficients."""
