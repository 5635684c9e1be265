"""The surrogates of a study, and how good they are."""
