"""What is known of a material beside its constants: other published values, and what it bears, each with its source."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

from solver.arrays import is_finite, shown
from solver.names import LIMITS

_MOST_ALTERNATIVES = 20


@dataclass(frozen=True)
class Limit:
    """What a material bears: a value in the unit of ``solver.names.LIMITS``, the lowest where sources differ."""

    value: float
    source: str


@dataclass(frozen=True)
class Alternative:
    """Other published values of some constants, to be taken together, in their SI units."""

    constants: dict[str, float]
    source: str


def read_limits(entries: object) -> dict[str, Limit]:
    """Limits from plain values, ``{name: {"value": 30e6, "source": "..."}}``."""
    limits = {}
    for name, entry in _mapping("limits", entries, LIMITS).items():
        fields = _mapping(f"limits: {name}", entry, ("value", "source"))
        value: Any = fields.get("value", "nothing")
        if not is_finite(value) or float(value) <= 0:
            raise ValueError(f"limits: {name}: value: {shown(value)} is not a finite number > 0 [{LIMITS[name].units}]")
        limits[name] = Limit(float(value), _source(f"limits: {name}", fields))
    return limits


def read_alternatives(entries: object, units: Mapping[str, str]) -> tuple[Alternative, ...]:
    """Alternatives from plain values, ``[{"eps33": 11e-9, "source": "..."}]``."""
    if not isinstance(entries, list | tuple):
        raise ValueError(f"alternatives: {shown(entries)} is not a list of constants with their source")
    if len(entries) > _MOST_ALTERNATIVES:
        raise ValueError(f"alternatives: {len(entries)} are more than {_MOST_ALTERNATIVES}")
    alternatives = []
    for number, entry in enumerate(entries, 1):
        where = f"alternatives: {number}"
        constants = dict(_mapping(where, entry, (*units, "source")))
        source = _source(where, constants)
        del constants["source"]
        if not constants:
            raise ValueError(f"{where}: no constant; known are {', '.join(units)}")
        for name, value in constants.items():
            if not is_finite(value):
                raise ValueError(f"{where}: {name}: {shown(value)} is not a finite number [{units[name]}]")
        alternatives.append(Alternative({name: float(value) for name, value in constants.items()}, source))
    return tuple(alternatives)


def _mapping(where: str, content: object, known: Collection[str]) -> Mapping[str, Any]:
    if not isinstance(content, Mapping):
        raise ValueError(f"{where}: {shown(content)} is not a mapping of {', '.join(known)}")
    for name in content:
        if name not in known:
            raise ValueError(f"{where}: {shown(name)}: unknown entry; known are {', '.join(known)}")
    return content


def _source(where: str, fields: Mapping[str, Any]) -> str:
    source = fields.get("source", "")
    if not isinstance(source, str) or not source.strip():
        raise ValueError(f"{where}: source: {shown(source)} is not a text that says where it comes from")
    return source
