"""Tests of workflow/dataset."""
