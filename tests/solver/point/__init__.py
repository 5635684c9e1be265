"""Tests of the room of point contacts."""
