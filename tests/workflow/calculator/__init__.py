"""Tests of workflow/measured."""
