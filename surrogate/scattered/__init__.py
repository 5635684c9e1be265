"""Gaussian processes on cases that form no factorial: a few exactly, many by finite rank."""
