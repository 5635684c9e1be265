"""Errors that name a factor, its value and the allowed values, and the warning of cases beyond the theory."""

from collections.abc import Sequence
from typing import Any


class FactorError(ValueError):
    """A factor that is unknown, missing or outside the allowed values."""


class CaseError(FactorError):
    """A case whose numbers have no solution, such as a load that needs tension or a speed above the limit."""


class SmallStrainWarning(UserWarning):
    """Contacts too wide or too deep for small strain, with the worst case and its numbers."""

    def __init__(self, message: str, excesses: Sequence[Any] = ()) -> None:
        super().__init__(message)
        self.excesses = tuple(excesses)
