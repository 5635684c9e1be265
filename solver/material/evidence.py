"""Evidence on a material beyond its constants: other published values, limits and thermal constants, with sources."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.arrays import is_finite, shown
from solver.described import Described
from solver.material.usual import question, questions
from solver.names import LIMITS, THERMAL
from solver.units import in_si

_MOST_ALTERNATIVES = 20


@dataclass(frozen=True)
class Sourced:
    """Limit or thermal constant of a material, in the unit of ``solver.names.LIMITS`` or ``THERMAL``."""

    value: float  # of a limit the lowest if sources differ
    source: str

    def plain(self, name: str) -> dict[str, Any]:
        """Return value and source as :func:`read_sourced` reads them."""
        units = {**LIMITS, **THERMAL}[name].units
        return {"value": with_unit({name: self.value}, {name: units})[name], "source": self.source}


@dataclass(frozen=True)
class Alternative:
    """Other published values of several constants, which belong together, in SI units."""

    constants: dict[str, float]
    source: str
    any_size: frozenset[str] = frozenset()  # constants that were given with their unit


def with_unit(values: Mapping[str, float], units: Mapping[str, str]) -> dict[str, float | str]:
    """Return plain values, with their unit as text where a bare number would be questioned."""
    unusual = questions({name: np.array(value) for name, value in values.items()}, units, values)
    return {name: f"{value!r} {units[name]}" if name in unusual else value for name, value in values.items()}


#: Sections of a material that hold values with sources.
SECTIONS: dict[str, Mapping[str, Described]] = {"limits": LIMITS, "thermal": THERMAL}
_ANY_SIGN = ("pyroelectric", "expansion")


def read_sourced(section: str, entries: object) -> dict[str, Sourced]:
    """Read the values of a section from ``{name: {"value": 30e6, "source": "..."}}``."""
    read = {}
    known = SECTIONS[section]
    for name, entry in _mapping(section, entries, known).items():
        fields = _mapping(f"{section}: {name}", entry, ("value", "source"))
        units, value = known[name].units, fields.get("value", "nothing")
        where, bare = f"{section}: {name}: value", not isinstance(value, str)
        value = _in_si(where, value, units)
        if not is_finite(value) or (float(value) <= 0 and name not in _ANY_SIGN):
            sign = "" if name in _ANY_SIGN else " > 0"
            raise ValueError(f"{where}: {shown(value)} is not a finite number{sign} [{units}]")
        if bare and (complaint := question(name, float(value), units)):
            raise ValueError(f"{section}: {complaint}")
        read[name] = Sourced(float(value), _source(f"{section}: {name}", fields))
    return read


def read_alternatives(entries: object, units: Mapping[str, str]) -> tuple[Alternative, ...]:
    """Read alternatives from ``[{"eps33": 11e-9, "source": "..."}]``."""
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
        texts = frozenset(name for name, value in constants.items() if isinstance(value, str))
        for name, value in constants.items():
            constants[name] = _in_si(f"{where}: {name}", value, units[name])
            if not is_finite(constants[name]):
                raise ValueError(f"{where}: {name}: {shown(value)} is not a finite number [{units[name]}]")
        alternatives.append(Alternative({name: float(value) for name, value in constants.items()}, source, texts))
    return tuple(alternatives)


def _in_si(where: str, value: Any, units: str) -> Any:
    """Return a text with its unit in SI, anything else unchanged."""
    try:
        return in_si(value, units) if isinstance(value, str) else value
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None


def _mapping(where: str, content: object, known: Collection[str]) -> Mapping[str, Any]:
    """Refuse what is not a mapping of known names."""
    if not isinstance(content, Mapping):
        raise ValueError(f"{where}: {shown(content)} is not a mapping of {', '.join(known)}")
    for name in content:
        if name not in known:
            raise ValueError(f"{where}: {shown(name)}: unknown entry; known are {', '.join(known)}")
    return content


def _source(where: str, fields: Mapping[str, Any]) -> str:
    """Return the source of an entry, which must be a text."""
    source = fields.get("source", "")
    if not isinstance(source, str) or not source.strip():
        raise ValueError(f"{where}: source: {shown(source)} is not a text that says where it comes from")
    return source
