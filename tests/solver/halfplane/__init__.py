"""Tests of the room solver/halfplane."""
