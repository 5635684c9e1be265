"""Tests of surrogate.intervals."""
