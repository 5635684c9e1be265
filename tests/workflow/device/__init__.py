"""Tests of signals in time."""
