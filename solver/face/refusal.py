"""Errors that name a factor, its value and the allowed values, and the warning of cases beyond the theory."""

from collections.abc import Sequence
from typing import Any


class FactorError(ValueError):
    """A factor that is unknown, missing or outside what is allowed."""


class CaseError(FactorError):
    """A case that has no answer by its numbers, where others of its kind have one.

    No single contact without tension carries its load, its speed is not below the limit, its punch is narrower than the
    contact, or the like.
    """


class SmallStrainWarning(UserWarning):
    """Contacts that are too wide or too deep for small strain, with the worst case and both numbers."""

    def __init__(self, message: str, excesses: Sequence[Any] = ()) -> None:
        super().__init__(message)
        self.excesses = tuple(excesses)
