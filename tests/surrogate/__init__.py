"""Tests of the room `surrogate`."""
