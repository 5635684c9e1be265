"""How many levels a factorial needs along each factor: pilots, decay of coefficients."""
