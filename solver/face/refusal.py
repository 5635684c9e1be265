"""Errors that name a factor, its value and the allowed values."""


class FactorError(ValueError):
    """A factor that is unknown, missing or outside what is allowed."""


class CaseError(FactorError):
    """A case that has no answer by its numbers, where others of its kind have one.

    No single contact without tension carries its load, its speed is not below the limit, its punch is narrower than the
    contact, or the like.
    """
