"""Tests of surrogate.scattered."""
