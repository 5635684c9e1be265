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

#: The name of a punch that does not deform.
RIGID_PUNCH = "rigid"


@dataclass(frozen=True)
class PunchMaterial:
    """An isotropic material of punches."""

    modulus: float  # Young's modulus [Pa]
    poisson: float  # Poisson's ratio [1]
    conducts: bool  # Whether it holds one potential as it comes
    source: str  # Where the numbers come from, and how far they spread
    density: float  # [kg/m3]
    thermal: Mapping[str, Sourced] = field(default_factory=dict)  # Constants for heat, as of other materials


@cache
def punches() -> Mapping[str, PunchMaterial]:
    """Every built-in material of punches by name; numbers and sources stand in ``solver/material/punches.toml``."""
    table = tomllib.loads(files("solver.material").joinpath("punches.toml").read_text(encoding="utf-8"))
    read = {
        name: {**entry, "thermal": read_sourced("thermal", entry.get("thermal", {}))} for name, entry in table.items()
    }
    return MappingProxyType({name: PunchMaterial(**entry) for name, entry in read.items()})


def find_punch(name: str) -> PunchMaterial:
    """The punch material of this name."""
    known = punches()
    if name not in known:
        near = nearest(name, known)
        hint = f"did you mean {near!r}? " if near else ""
        raise MaterialError(f"punch: {shown(name)} is unknown; {hint}known are {RIGID_PUNCH}, {', '.join(known)}")
    return known[name]
