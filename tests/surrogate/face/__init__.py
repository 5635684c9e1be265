"""Tests of surrogate.face."""
