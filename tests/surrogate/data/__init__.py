"""Tests of surrogate/data."""
