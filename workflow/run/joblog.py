"""The log file of a job: what was done, and the whole story where it failed."""

import logging
import sys
from pathlib import Path
from types import TracebackType

log = logging.getLogger("meecontact")


def start(path: str) -> None:
    """Log to a file; an exception goes there in full and to the terminal in one line."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    logging.captureWarnings(capture=True)
    logging.raiseExceptions = False  # a log that cannot be written (disk full) must not hide the job's own error
    logging.basicConfig(
        filename=path, filemode="w", force=True, level=logging.INFO, format="%(levelname)s %(name)s: %(message)s"
    )

    def report(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        log.error("failed", exc_info=(kind, error, trace))
        print(f"{kind.__name__}: {error}", file=sys.stderr)

    sys.excepthook = report
