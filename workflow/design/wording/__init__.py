"""The answer to a design question in words and tables."""
