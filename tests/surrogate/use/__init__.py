"""Tests of surrogate/use."""
