"""Contacts in space."""
