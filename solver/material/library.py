"""The built-in materials."""

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from importlib.resources import files
from types import MappingProxyType

from solver.arrays import nearest, shown
from solver.material.constants import Material, MaterialError
from solver.material.cuts import split


@cache
def materials() -> Mapping[str, Material]:
    """Return every built-in material by name; constants and sources are in ``solver/material/materials.toml``.

    Examples
    --------
    >>> "PZT-4" in materials(), materials()["steel"].name
    (True, 'steel')
    """
    table = tomllib.loads(files("solver.material").joinpath("materials.toml").read_text(encoding="utf-8"))
    return MappingProxyType({name: Material.from_mapping({"name": name, **entry}) for name, entry in table.items()})


def find(name: str, more: Mapping[str, Material] = MappingProxyType({})) -> Material:
    """Return the material of a name.

    ``NAME (alternative 1)`` has the constants of the first alternative of NAME, and so on. ``36Y NAME``, ``X NAME`` and
    ``tilt 10 deg NAME`` are cuts of it (see ``solver/material/cuts.py``).

    Parameters
    ----------
    name : str
    more : mapping of str to Material, a user's own, which come before the built-in ones

    Raises
    ------
    MaterialError
        Naming the nearest known name, or all of them where none is near.

    Examples
    --------
    >>> low, high = find("BaTiO3").spread["eps33"]
    >>> float(find("BaTiO3 (alternative 1)").eps33) == low
    True
    >>> find("36Y LiNbO3").cut
    '36Y'
    """
    known = {**materials(), **more}
    if name not in known and (parts := split(name)):
        crystal = find(parts[1], more)
        if crystal.cut:
            raise MaterialError(f"material: {shown(name)}: {parts[1]} has a cut already: {crystal.cut}")
        return replace(crystal, cut=parts[0], name=name)
    if name not in known:
        origin = known.get(name.partition(" (alternative ")[0])
        for variant in origin.variants() if origin else ():
            if variant.name == name:
                return variant
        near = nearest(name, known)
        hint = f"did you mean {near!r}?" if near else f"known are {', '.join(known)}"
        raise MaterialError(f"material: {shown(name)} is unknown; {hint}")
    return known[name]
