"""Largest values of curves: the curves are learnt, which are smooth, and the maximum is taken after the query."""
