"""The answer told: its verdict in words, its tables."""
