"""Tests of workflow/run."""
