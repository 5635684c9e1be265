"""Predictive distributions, calibrated on held-out cases at every level and everywhere in the box."""
