"""The labelled face: named factors in, an ``xarray.Dataset`` with units out."""
