"""Design questions, their search on the surrogate, the exact verdict, and the wording of the answer."""
