"""Tests of workflow/design."""
