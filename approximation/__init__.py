"""Functions by their values at Chebyshev points: series, panels of them, and where measures of them are largest."""
