"""Surrogates that measured rows have corrected."""
