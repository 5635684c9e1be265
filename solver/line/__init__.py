"""Sliding contact on films: layered and graded bodies on a rigid base or a half-plane (theory of films)."""
