"""Tests of approximation."""
