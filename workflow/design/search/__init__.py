"""The best design: searched on the surrogate, polished on the exact solver."""
