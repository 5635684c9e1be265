"""Tests of workflow/learning."""
