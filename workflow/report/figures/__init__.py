"""Figures that matplotlib draws, one file a chapter of the page."""
