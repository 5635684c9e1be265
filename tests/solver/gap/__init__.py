"""Air beside a contact."""
