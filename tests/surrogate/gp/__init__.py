"""Tests of surrogate/gp."""
