"""Materials of punches: isotropic, by Young's modulus and Poisson's ratio."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from types import MappingProxyType

from solver.arrays import nearest, shown
from solver.material.constants import MaterialError
from solver.material.evidence import Sourced, read_sourced

#: Name of a rigid punch.
RIGID_PUNCH = "rigid"


@dataclass(frozen=True)
class PunchMaterial:
    """An isotropic material of punches."""

    modulus: float  # Young's modulus [Pa]
    poisson: float  # Poisson's ratio [1]
    conducts: bool  # Whether it conducts without a coating
    source: str  # Origin and spread of the numbers
    density: float  # [kg/m3]
    thermal: Mapping[str, Sourced] = field(default_factory=dict)  # Thermal constants


@cache
def punches() -> Mapping[str, PunchMaterial]:
    """Return every built-in material of punches by name, from ``solver/material/punches.toml``."""
    table = tomllib.loads(files("solver.material").joinpath("punches.toml").read_text(encoding="utf-8"))
    known = {}
    for name, entry in table.items():
        thermal = read_sourced("thermal", entry.pop("thermal", {}))
        known[name] = PunchMaterial(**entry, thermal=thermal)
    return MappingProxyType(known)


def find_punch(name: str) -> PunchMaterial:
    """Return the punch material of a name, or suggest the nearest one."""
    known = punches()
    if name not in known:
        near = nearest(name, known)
        hint = f"did you mean {near!r}? " if near else ""
        raise MaterialError(f"punch: {shown(name)} is unknown; {hint}known are {RIGID_PUNCH}, {', '.join(known)}")
    return known[name]
