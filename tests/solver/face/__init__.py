"""Tests of the room solver/face."""
