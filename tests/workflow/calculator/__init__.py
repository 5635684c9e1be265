"""Tests of workflow/calculator."""
