"""Numeric factors by name: the solver's, and a study's own for lower layers of its body, as ``copper_thickness``."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

from solver import names
from solver.described import Factor

#: Numbers of a layer, by the factors of a single film; the ending of an own name is one of them.
OF_A_LAYER = ("thickness", "volume_fraction", "scandium_fraction")

_OWN = re.compile(rf"[A-Za-z][A-Za-z0-9_]{{0,39}}_(?P<kind>{'|'.join(OF_A_LAYER)})")


class _Factors(Mapping[str, Factor]):
    """The solver's factors, and own names, which lookup finds but iteration leaves out."""

    def __getitem__(self, name: str) -> Factor:
        if (kind := own_kind(name)) is None:
            return names.FACTORS[name]
        return replace(names.FACTORS[kind], long_name=name.replace("_", " "), default=None, optional=False)

    def __iter__(self) -> Iterator[str]:
        return iter(names.FACTORS)

    def __len__(self) -> int:
        return len(names.FACTORS)


#: Unit, meaning and bounds of every factor, own names included.
FACTORS: Mapping[str, Factor] = _Factors()


def own_kind(name: object) -> str | None:
    """Return the ending of an own name, one of `OF_A_LAYER`; None for any other name."""
    match = None if name in names.FACTORS or not isinstance(name, str) else _OWN.fullmatch(name)
    return match["kind"] if match else None
