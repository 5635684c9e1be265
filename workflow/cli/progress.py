"""Progress of a run: a line for each step, and on a terminal one line that counts them."""

import logging
import shutil
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, redirect_stderr
from typing import Any, TextIO, cast

from workflow.language.numbers import counted
from workflow.study import partition
from workflow.study.model import Study

#: Work of a run's steps in words, by rule, with the wildcards of a job in braces.
_RULES = {
    "levels": "choosing the levels on pilots",
    "slab": "solving the data set, part {slab}",
    "places": "asking for cases, round {round}",
    "batch": "solving round {round} of the cross approximation, part {slab}",
    "quantities": "gathering the quantities",
    "card": "describing the data set",
    "cases": "solving random cases",
    "calibration": "solving random cases for the intervals",
    "surrogate": "fitting the surrogate",
    "surface": "fitting the fields under the punch",
    "validation": "comparing the surrogate with exact cases",
    "sensitivity": "apportioning the variance to the factors",
    "target": "target {name}",
    "design": "gathering the designs",
    "readout": "read-out {name}",
    "press": "a press in time",
    "effect": "effect of {name}",
    "interior": "effect of {name} below the punch",
    "map": "maps of the contact over {name}",
    "spread": "effect of {name} on random surfaces",
    "check": "verification {group}",
    "verdict": "judging the verification",
    "measurements": "asking the model for what was measured",
    "figure_measurements": "drawing what was measured",
    "provenance": "recording where the results come from",
    "solved": "solving what the page tells of the designs",
    "sweeps": "gathering the effects of the baseline",
    "report": "writing the page",
}
_CLEAR = "\r\x1b[K"


def step(study: Study, rule: str, wildcards: Mapping[str, str]) -> str:
    """Return the work of a job in words."""
    names = {name: value.replace("_", " ") for name, value in wildcards.items()}
    if rule == "slab":
        return f"solving the data set, part {int(names['slab']) + 1} of {partition.count(study)}"
    words = _RULES.get(rule, f"drawing {rule.removeprefix('figure_').replace('_', ' ')} {{name}}{{group}}")
    words = words.format_map({"name": "", "group": "", **names}).strip()
    if rule == "surrogate" and not study.open:
        cases = "" if study.crossed else f", {counted(study.cases)} cases"
        words += f" ({len(study.outputs)} quantities{cases})"
    return words


class Progress(logging.Filter):
    """Filter that prints one counting line on a terminal, or a line a job in a log; errors of Snakemake pass."""

    def __init__(self, study: Study, stream: TextIO) -> None:
        super().__init__()
        self._study, self._stream = study, stream
        self._terminal = stream.isatty()
        self._running: dict[int, str] = {}
        self._done, self._total = 0, 0

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether Snakemake's own line is shown."""
        event = str(getattr(getattr(record, "event", None), "value", ""))
        if event == "job_info":
            self._begin(record)
        elif event == "job_finished":
            self._running.pop(int(record.__dict__.get("job_id", -1)), None)
        elif event == "progress":
            self._done, self._total = record.__dict__["done"], record.__dict__["total"]
        elif record.levelno >= logging.WARNING or record.getMessage().startswith("Nothing to be done"):
            self.clear()
            return True
        self._show()
        return False

    def clear(self) -> None:
        """Take the line from the terminal."""
        if self._terminal:
            print(end=_CLEAR, file=self._stream, flush=True)

    def _begin(self, record: logging.LogRecord) -> None:
        words = step(self._study, str(record.__dict__["rule_name"]), dict(record.__dict__.get("wildcards") or {}))
        self._running[int(record.__dict__["jobid"])] = words
        if not self._terminal:
            print(words, file=self._stream, flush=True)

    def _show(self) -> None:
        if not self._terminal or not self._running:
            return
        share = f"{self._done} of {self._total} steps done; " if self._total else ""
        line = f"{share}{', '.join(self._running.values())}"
        print(end=_CLEAR + line[: shutil.get_terminal_size().columns - 1], file=self._stream, flush=True)


class _Unprofiled:
    """Stream of errors without Snakemake's line about its profile."""

    def __init__(self, stream: TextIO) -> None:
        self._stream, self._left_out = stream, False

    def write(self, text: str) -> int:
        if text.startswith("Using workflow specific profile"):
            self._left_out = True
        elif self._left_out and text == "\n":  # `print` writes the end of its line separately
            self._left_out = False
        else:
            self._stream.write(text)
        return len(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


@contextmanager
def followed(study: Study, stream: TextIO | None = None) -> Iterator[None]:
    """Report the progress of Snakemake's run in this process by the steps of a study."""
    shown, logger = Progress(study, stream or sys.stderr), logging.getLogger("snakemake.logging")

    def installed(record: logging.LogRecord) -> bool:
        """Filter also the handler that writes to the terminal, which Snakemake makes when its run begins."""
        for handler in logger.handlers:
            if handler.name == "DefaultStreamHandler" and shown not in handler.filters:
                handler.addFilter(shown)
        return True

    logger.addFilter(installed)
    try:
        with redirect_stderr(cast(TextIO, _Unprofiled(sys.stderr))):
            yield
    finally:
        logger.removeFilter(installed)
        shown.clear()


@contextmanager
def busy(words: str) -> Iterator[None]:
    """Show a message on a terminal while work takes a while; nothing in a log."""
    message, clear = (f"{_CLEAR}{words} ...", _CLEAR) if sys.stderr.isatty() else ("", "")
    print(message, end="", file=sys.stderr, flush=True)
    try:
        yield
    finally:
        print(clear, end="", file=sys.stderr, flush=True)
