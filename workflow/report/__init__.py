"""The page of a study, and the panel on it that answers."""
