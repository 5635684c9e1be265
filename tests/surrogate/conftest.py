"""Files of models are read in this process; tests/faults proves the child that reads hostile files."""

from collections.abc import Iterator

import pytest

from storage.quarantine import try_to_read
from storage.sealed import check_seal
from surrogate.face import persistence


@pytest.fixture(autouse=True, scope="module")
def _in_this_process() -> Iterator[None]:
    """No child is started for every file of a test's own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(persistence, "try_to_read", check_seal)
        yield


@pytest.fixture
def quarantined(monkeypatch: pytest.MonkeyPatch) -> None:
    """Read files of models in a child process, as shipped."""
    monkeypatch.setattr(persistence, "try_to_read", try_to_read)
