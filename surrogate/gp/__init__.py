"""Gaussian processes on factorials and on scattered cases, their calibrated intervals and their files."""
