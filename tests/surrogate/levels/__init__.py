"""Tests of surrogate/levels."""
