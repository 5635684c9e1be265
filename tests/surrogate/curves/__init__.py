"""Tests of surrogate.curves."""
