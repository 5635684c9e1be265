"""Tests of surrogate.transforms."""
