"""What the face refuses."""


class FactorError(ValueError):
    """A factor that is unknown, missing or outside what is allowed."""
