"""The configuration of the pipeline, from every place where Snakemake takes one: it holds the key ``study`` alone."""

from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from typing import Any

from workflow.study.reading import InputError

KEY, USUAL = "study", "quickstart"
_INSTEAD = (
    "the pipeline reads the key 'study' alone; write --config study=NAME or study=PATH.yaml (config: in a profile or a "
    "module), and everything else in the study's file"
)


def study(config: Mapping[str, Any], entries: Iterable[str] | None) -> str:
    """Study that a configuration names, the quickstart by default; InputError for any other content."""
    unread = [str(name) for name in config if name != KEY]
    if unread:
        meant = get_close_matches(unread[0].lower(), [KEY], 1, 0.5)
        hint = f"did you mean {KEY!r}? " if meant and KEY not in config else ""
        shown = ", ".join(map(repr, unread[:3])) + (", ..." if len(unread) > 3 else "")
        raise InputError(f"config: {shown}: not read; {hint}{_INSTEAD}")
    # the arguments of --config as they were written: Snakemake lets the last of two equal keys win
    written = [entry for entry in entries or () if entry.partition("=")[0] == KEY]
    if len(written) > 1:
        raise InputError(f"config: {' '.join(written)}: {KEY} is given {len(written)} times; must be given once")
    value = config.get(KEY, USUAL)
    if isinstance(value, Mapping | list) or not str(value or "").strip():
        raise InputError(f"config: {KEY}: {value!r} is no study; must be a name, or the path of a study's file")
    return str(value)
