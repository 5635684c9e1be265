"""Robust constrained optimisation on a box, for one objective and for several."""
