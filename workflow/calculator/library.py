"""The library as plain data for the calculator: materials with their bands and limits, punches, units and names."""

from typing import Any

import numpy as np

from solver import units
from solver.halfplane.shape import DIGAMMA_SERIES
from solver.material.constants import UNITS, VACUUM_PERMEABILITY, VACUUM_PERMITTIVITY, Material
from solver.material.laws import compose
from solver.material.library import find, materials
from solver.material.punches import punches
from solver.names import ALL_QUANTITIES, FACTORS, LIMITS
from workflow.calculator.films import FILMS, THICKNESSES, top_of
from workflow.language.evidence import unverified
from workflow.language.titles import title

_SYMBOLS = ("m", "g", "s", "A", "K", "N", "Pa", "J", "C", "V", "F", "T", "Wb", "H", "Ohm")
_PREFIXES = ("f", "p", "n", "u", "µ", "μ", "m", "c", "k", "M", "G", "T")


def library() -> dict[str, Any]:
    """Everything but the tables of films."""
    return {
        "constants": UNITS,
        "defaults": {"eps": VACUUM_PERMITTIVITY, "mu": VACUUM_PERMEABILITY},
        "materials": {name: _marked(material.plain()) for name, material in materials().items()},
        "alloy": _alloy(),
        "films": {
            name: {"factors": film, "top": _marked(top_of(film).plain()), "thickness": THICKNESSES[name]}
            for name, film in FILMS.items()
        },
        "punches": {name: {"modulus": punch.modulus, "poisson": punch.poisson} for name, punch in punches().items()},
        "limits": {name: {"title": title(name), "units": limit.units} for name, limit in LIMITS.items()},
        "units": {name: described.units for name, described in (ALL_QUANTITIES | FACTORS).items()},
        "symbols": {symbol: _measured(symbol) for symbol in _SYMBOLS},
        "prefixes": {prefix: units.parse(f"{prefix}m").scale for prefix in _PREFIXES},
        "digamma": DIGAMMA_SERIES.tolist(),
    }


def _alloy() -> dict[str, Any]:
    """Al(1-x)Sc(x)N: every constant is a parabola in x, given by its values at 0, 1/4 and 1/2."""
    phases = find("BaTiO3"), find("CoFe2O4")  # which this alloy has not
    alloy: Material = compose("AlScN", phases, np.array([0.0, 0.25, 0.5]))
    constants = {name: getattr(alloy, name) for name in UNITS}
    return {
        "values": {
            name: np.broadcast_to(values, (3,)).tolist()
            for name, values in constants.items()
            if not np.any(np.isnan(values))
        },
        "source": alloy.source,
        "limits": _marked(compose("AlScN", phases, 0.3).plain())["limits"],
    }


def _marked(material: dict[str, Any]) -> dict[str, Any]:
    """A material whose limits say where they were not read at their sources."""
    limits = material["limits"].items()
    return material | {
        "limits": {name: limit | {"source": limit["source"] + unverified(limit["source"])} for name, limit in limits}
    }


def _measured(symbol: str) -> list[Any]:
    unit = units.parse(symbol)
    return [unit.scale, [int(exponent) for exponent in unit.exponents]]
