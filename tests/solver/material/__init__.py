"""Tests of the room solver/material."""
