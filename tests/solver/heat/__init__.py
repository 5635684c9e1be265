"""Tests of solver/heat."""
