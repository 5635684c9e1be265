"""The pipeline's configuration, which holds the key ``study`` alone, wherever Snakemake reads it from."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import yaml

from workflow.study.reading import InputError

KEY, USUAL = "study", "quickstart"
_INSTEAD = (
    "the pipeline reads the key 'study' alone; write --config study=NAME or study=PATH.yaml (config: in a profile or a "
    "module), and everything else in the study's file"
)


def study(config: Mapping[str, Any], entries: Iterable[str] | None) -> str:
    """Return the study that a configuration names, the quickstart by default; InputError for any other content."""
    check_keys("config", config)
    # the arguments of --config as they were written: Snakemake lets the last of two equal keys win
    written = [entry for entry in entries or () if entry.partition("=")[0] == KEY]
    if len(written) > 1:
        raise InputError(f"config: {' '.join(written)}: {KEY} is given {len(written)} times; must be given once")
    value = config.get(KEY, USUAL)
    if isinstance(value, Mapping | list) or not str(value or "").strip():
        raise InputError(f"config: {KEY}: {value!r} is no study; must be a name, or the path of a study's file")
    return str(value)


def check_keys(where: str, config: object) -> None:
    """Raise InputError, in one line, for keys that the pipeline does not read."""
    if not isinstance(config, Mapping):
        raise InputError(f"{where}: {config!r} is no mapping; {_INSTEAD}")
    unread = [str(name) for name in config if name != KEY]
    if unread:
        meant = get_close_matches(unread[0].lower(), [KEY], 1, 0.5)
        hint = f"did you mean {KEY!r}? " if meant and KEY not in config else ""
        shown = ", ".join(map(repr, unread[:3])) + (", ..." if len(unread) > 3 else "")
        raise InputError(f"{where}: {shown}: not read; {hint}{_INSTEAD}")


def check_profiles(arguments: Sequence[str]) -> None:
    """Raise InputError for a profile with configuration: Snakemake drops it silently behind the command line's."""
    for file in _profiles(arguments):
        content = _content(file)
        if (config := content.get("config")) is not None:
            entries = config if isinstance(config, list) else []
            pairs = {str(entry).partition("=")[0]: str(entry).partition("=")[2] for entry in entries}
            check_keys(f"{file}: config", pairs if entries else config)
        for key in ("configfile", "configfiles"):
            names = content.get(key) or []
            for name in [names] if isinstance(names, str) else names:
                paths = [path for path in (file.parent / name, Path(name)) if path.is_file()]
                if paths:
                    check_keys(str(paths[0]), _content(paths[0]))


def _content(file: Path) -> dict[str, Any]:
    """Return the mapping in a YAML file, empty where Snakemake itself will refuse it."""
    try:
        content = yaml.safe_load(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, yaml.YAMLError):
        return {}
    return content if isinstance(content, dict) else {}


def _profiles(arguments: Sequence[str]) -> Iterator[Path]:
    """Yield the profiles' files of a Snakemake command, that of SNAKEMAKE_PROFILE included."""
    from snakemake.cli import get_argument_parser, get_profile_dir, resolve_snakefile

    options, _ = get_argument_parser().parse_known_args(list(arguments))
    for name in options.profile or []:
        if name != "none" and (profile := get_profile_dir(name)):
            yield profile[1]
    if options.workflow_profile != "none":
        wanted = Path(options.workflow_profile or "default")
        snakefile = resolve_snakefile(options.snakefile, allow_missing=True)
        bundled = [Path(snakefile).parent / "profiles" / wanted] if snakefile else []
        places = [*([wanted] if options.workflow_profile else []), Path("profiles") / wanted, *bundled]
        folder = next((place for place in places if place.exists()), None)
        if folder and (profile := get_profile_dir(str(folder))):
            yield profile[1]
