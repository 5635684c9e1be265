"""Gaussian processes: grids, tensor trains from few cases, scattered cases, finite rank."""
