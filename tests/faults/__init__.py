"""Faults that are really made: processes die, disks fill and files are changed."""
