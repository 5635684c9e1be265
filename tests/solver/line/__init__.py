"""Tests of the room of films."""
