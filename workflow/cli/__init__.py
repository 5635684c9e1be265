"""The command ``meecontact``."""
