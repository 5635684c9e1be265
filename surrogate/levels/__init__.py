"""Number of levels that a factorial needs along each factor, from pilots and the decay of coefficients."""
