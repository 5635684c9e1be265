"""The calculator's page: one file without a server, with the library as plain data."""

import json
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from solver import units
from solver.face.strain import DEEP, WIDE
from solver.halfplane.sliding import digamma_series
from solver.material.composite import compose
from solver.material.constants import UNITS, VACUUM_PERMEABILITY, VACUUM_PERMITTIVITY, Material
from solver.material.library import find, materials
from solver.material.punches import punches
from solver.names import ALL_QUANTITIES, FACTORS, LIMITS
from workflow.calculator.films import FILMS, THICKNESSES, tables, top_of
from workflow.language.titles import title
from workflow.language.wordings import unverified

TEMPLATES = Path(__file__).parent / "templates"
NUMBERS = Path(__file__).parents[1] / "report/templates/numbers.js"
#: Scripts of what is calculated, which need no page, in their order.
CALCULATING = ("body.js", "line.js", "point.js", "entry.js")
_SHOWING = ("drawing.js", "app.js")

_EXAMPLE = """# a soft PZT; what is left out is zero, or vacuum's
name = "my PZT"
c11 = 126 GPa
c12 = 79.5 GPa
c13 = 84.1 GPa
c33 = 117 GPa
c44 = 23.0 GPa
e31 = -6.5 C/m2
e33 = 23.3 C/m2
e15 = 17.0 C/m2
eps11 = 15.05 nF/m
eps33 = 13.02 nF/m
depoling_stress = 10 MPa
"""
_SYMBOLS = ("m", "g", "s", "A", "K", "N", "Pa", "J", "C", "V", "F", "T", "Wb", "H", "Ohm")
_PREFIXES = ("f", "p", "n", "u", "µ", "μ", "m", "c", "k", "M", "G", "T")


def page() -> str:
    """Return the page as HTML."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES), autoescape=True, undefined=StrictUndefined, keep_trailing_newline=True
    )
    return environment.get_template("calculator.html.j2").render(
        style=Markup((TEMPLATES / "calculator.css").read_text(encoding="utf-8")),
        script=Markup(script((*CALCULATING, *_SHOWING))),
        library=_embedded(library()),
        films=_embedded(tables()),
        example=_EXAMPLE,
    )


def script(names: tuple[str, ...] = CALCULATING) -> str:
    """Return scripts one after the other, numbers.js first."""
    parts = [NUMBERS, *(TEMPLATES / name for name in names)]
    return "\n".join(part.read_text(encoding="utf-8") for part in parts)


def _embedded(content: Any) -> Markup:
    """Return plain data as JSON whose content cannot end the script element."""
    text = json.dumps(content, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return Markup(text.replace("<", "\\u003c"))


def library() -> dict[str, Any]:
    """Return the calculator's data but for the tables of films."""
    return {
        "constants": UNITS,
        "defaults": {"eps": VACUUM_PERMITTIVITY, "mu": VACUUM_PERMEABILITY},
        "materials": {name: _marked(material.plain()) for name, material in materials().items() if material.axial},
        "alloy": _alloy(),
        "films": {
            name: {"factors": film, "top": _marked(top_of(film).plain()), "thickness": THICKNESSES[name]}
            for name, film in FILMS.items()
        },
        "punches": {name: {"modulus": punch.modulus, "poisson": punch.poisson} for name, punch in punches().items()},
        "limits": {name: {"title": title(name), "units": limit.units} for name, limit in LIMITS.items()},
        "small_strain": {"wide": WIDE, "deep": DEEP},
        "units": {name: described.units for name, described in (ALL_QUANTITIES | FACTORS).items()},
        "symbols": {symbol: _measured(symbol) for symbol in _SYMBOLS},
        "prefixes": {prefix: units.parse(f"{prefix}m").scale for prefix in _PREFIXES},
        "digamma": digamma_series().tolist(),
    }


def _alloy() -> dict[str, Any]:
    """Return Al(1-x)Sc(x)N: every constant is a parabola in x, by its values at 0, 1/4 and 1/2."""
    phases = find("BaTiO3"), find("CoFe2O4")  # which the alloy does not use
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
    """Return a material with a mark at limits that were not read at their sources."""
    limits = material["limits"].items()
    return {name: entry for name, entry in material.items() if name != "thermal"} | {
        "limits": {name: limit | {"source": limit["source"] + unverified(limit["source"])} for name, limit in limits}
    }


def _measured(symbol: str) -> list[Any]:
    unit = units.parse(symbol)
    return [unit.scale, [int(exponent) for exponent in unit.exponents]]
