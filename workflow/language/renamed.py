"""Names of quantities of the release before: read until the next release, each replaced and reported once."""

import re
import sys
from collections.abc import Collection
from typing import Any

from solver.body import KINDS
from solver.names import CHOICES, PROFILES
from workflow.language.wordings import RENAMED

_SUFFIXES = ("_std", "_gain", "_offset")  # of columns and options that belong to a quantity
_OLD = re.compile(rf"\b({'|'.join(RENAMED)})({'|'.join(_SUFFIXES)})?\b")
_SECTIONS = ("surrogate", "design", "readout")  # parts of a study that name quantities

_reported: set[str] = set()


def renamed(content: Any, known: Collection[str]) -> Any:
    """Return texts, and lists and mappings of them, with known names in place of old ones."""
    if isinstance(content, str):
        return _OLD.sub(lambda match: _present(match, known), content)
    if isinstance(content, list):
        return [renamed(entry, known) for entry in content]
    if isinstance(content, dict):
        return {renamed(key, known): renamed(entry, known) for key, entry in content.items()}
    return content


def renamed_study(content: dict[str, Any]) -> dict[str, Any]:
    """Return the mapping of a study's file with present names of quantities in all sections that have any."""
    contacts = _contacts(content)
    known = {name for kind in KINDS.values() if kind.contact in contacts for name in kind.every_quantity}
    return {key: renamed(part, known) if key in _SECTIONS else part for key, part in content.items()}


def _contacts(content: dict[str, Any]) -> set[str]:
    """Return the kinds of contact of an unchecked study: both, if its profile is unknown or a force varies."""
    profile, factors = _profile(content), content.get("factors")
    contact = PROFILES[profile].contact if profile in PROFILES else None
    if contact == "point" or (contact and not (isinstance(factors, dict) and "force" in factors)):
        return {contact}
    return {kind.contact for kind in KINDS.values()}


def _profile(content: dict[str, Any]) -> str:
    """Return the first profile of an unchecked study; all profiles of a study have one kind of contact."""
    for section in ("categories", "fixed"):
        part = content.get(section)
        profile = part.get("profile") if isinstance(part, dict) else None
        if isinstance(profile, list) and profile:
            profile = profile[0]
        if isinstance(profile, str):
            return profile
    return CHOICES["profile"][0]


def _present(match: re.Match[str], known: Collection[str]) -> str:
    old, new = match[1], RENAMED[match[1]]
    if old in known or new not in known:
        return match[0]
    if old not in _reported:
        _reported.add(old)
        print(f"{old} is now called {new}; the old name is read until the next release", file=sys.stderr)
    return f"{new}{match[2] or ''}"
