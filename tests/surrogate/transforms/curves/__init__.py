"""Tests of surrogate.transforms.curves."""
