"""Refusals in one line."""

from collections.abc import Callable
from typing import Any

import pytest


def assert_refused(
    kind: type[Exception] | tuple[type[Exception], ...], match: str, function: Callable[..., object], /,
    *arguments: Any, **options: Any,
) -> None:  # fmt: skip
    """Check that a call raises an error whose message is one line that matches an expression."""
    with pytest.raises(kind, match=match) as caught:
        function(*arguments, **options)
    assert "\n" not in str(caught.value)
