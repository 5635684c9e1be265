"""Tests of surrogate/search."""
