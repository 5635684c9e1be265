"""Number of levels that a factorial needs along each factor: pilots, decay of coefficients."""
