"""Tests of workflow/language."""
