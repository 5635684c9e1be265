"""Inputs, query points and complete factorials."""
