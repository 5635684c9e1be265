"""The face of every surrogate: what a model must give, what is asked of it by name, and its files."""
