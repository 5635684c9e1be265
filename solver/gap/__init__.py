"""Contacts of conducting punches in air (theory section 10; points, 6 and 8)."""
