"""Films of the calculator: balls, cones and discs on a few stacks, as Chebyshev series for a browser.

The surface beside cones and discs is insulated. Their series are in log(radius/thickness): `loads` of loads and edges
by channel and cause, `pressures` by place and cause. Air surrounds a ball, which two dimensionless numbers describe:
`air` has its quantities as series in both. Tables under other published constants of the film or its base make the band
of a figure, with fewer digits and the pressure at the centre alone.

The tables take four minutes, so ``films.json`` stores them. ``python -m workflow.calculator.films [FILM ...]`` writes
it anew.
"""

import json
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from approximation.chebyshev import coefficients, mapped_points
from solver.arrays import Array
from solver.face.solution import solve
from solver.halfplane.sliding import Punch
from solver.line.windows import number_of
from solver.material.composite import compose
from solver.material.constants import Material
from solver.material.library import find
from solver.material.punches import RIGID_PUNCH, find_punch
from solver.point.profile import SAMPLES, Shape
from solver.point.system import added_forms
from solver.point.table import PointKind, window
from solver.stack.layers import Layer, Stack

#: Factors of films by their title.
FILMS: dict[str, dict[str, Any]] = {
    "PZT-4 on steel": {"material": "PZT-4", "base": "steel"},
    "PZT-4 on silicon": {"material": "PZT-4", "base": "silicon"},
    "AlN on silicon": {"material": "AlN", "base": "silicon"},
    "AlScN (30 % Sc) on silicon": {"composite": "AlScN", "scandium_fraction": 0.3, "base": "silicon"},
    "PVDF on glass": {"material": "PVDF", "base": "glass"},
}
#: Usual thickness of each film.
THICKNESSES = dict(zip(FILMS, ("50 um", "1 um", "1 um", "1 um", "110 um"), strict=True))
#: Materials of the punches.
PUNCHES = (RIGID_PUNCH, "steel", "tungsten_carbide")
#: Radius of the contact over the thickness of the film, from and to.
RANGE = 0.01, 10.0
#: Of a ball in air: load = force * radius / (thickness^3 c33), and radius / (thickness load^(1/4)), from and to.
AIR_RANGE = (1e-6, 1e4), (2.0, 3e4)
_STORED = Path(__file__).parent / "films.json"
_TABLE_NODES = 48
_AIR_NODES, _AIR_BAND_NODES = (20, 14), (14, 10)
_AIR_EXACT, _AIR_BAND = 1e-5, 1e-4  # of the largest value, or of the value itself where its logarithm is stored
_LOGARITHMS = ("contact_radius", "depth", "peak_pressure", "contact_stiffness", "capacitance")
_SIGNED = ("charge_per_force", "stroke_per_volt")
_EXACT, _BAND, _DRAWN = 1e-8, 1e-5, 1e-4  # of the largest coefficient of a series; smaller ones are left out
_CHANNELS = [0, 1]  # displacement and voltage
_CAUSES = [0, 1, 3]  # displacement, voltage and profile of a ball; the profile of a cone follows
_SHAPES = (Shape(2.0), Shape(1.0))
_SHOWN = np.arange(2, SAMPLES.size, 3)  # places at which the pressure is given, the centre among them


def top_of(film: dict[str, Any]) -> Material:
    """Return the material of a film."""
    if "material" in film:
        return find(str(film["material"]))
    return compose(str(film["composite"]), (find("BaTiO3"), find("CoFe2O4")), film["scandium_fraction"])


def variants(film: dict[str, Any]) -> Iterator[tuple[Material, Material]]:
    """Yield top and base of a film: the library's, then each with its other published constants in turn."""
    top, base = top_of(film), find(str(film["base"]))
    yield top, base
    yield from ((variant, base) for variant in top.variants())
    yield from ((top, variant) for variant in base.variants())


def tables(names: Iterable[str] = FILMS) -> list[dict[str, Any]]:
    """Return the films under every punch, and their `variants` by constants, as rising series of coefficients."""
    return [table for table in _stored() if table["film"] in {*names}]


@cache
def _stored() -> list[dict[str, Any]]:
    stored: list[dict[str, Any]] = json.loads(_STORED.read_text(encoding="utf-8"))
    return stored


def solved(name: str, punch: str) -> dict[str, Any]:
    """Return the tables of one film under one punch, computed anew."""
    (top, base), *others = variants(FILMS[name])
    low, high = np.log(RANGE)
    header = {"film": name, "punch": punch, "range": [low, high], "samples": SAMPLES[_SHOWN].tolist()}
    varied = []
    for other, below in others:
        constants = {key: number for key, number in other.plain().items() if isinstance(number, float)}
        tabled = _table(other, below, punch, _BAND, SAMPLES.size - 1)
        varied.append(
            {"top": constants, "samples": [1.0], **tabled, "air": _air(other, below, punch, _AIR_BAND_NODES, _AIR_BAND)}
        )
    nominal = _table(top, base, punch, _EXACT, *_SHOWN)
    return header | nominal | {"air": _air(top, base, punch, _AIR_NODES, _AIR_EXACT), "variants": varied}


def _air(top: Material, base: Material, punch: str, shape: tuple[int, int], precision: float) -> dict[str, Any]:
    """Return ranges, and series by quantity of a ball in air on a film of unit thickness, by degree in the load."""
    load_ends, size_ends = np.log(AIR_RANGE)
    load, size = np.meshgrid(mapped_points(shape[0], *load_ends), mapped_points(shape[1], *size_ends), indexing="ij")
    radius = np.exp(size + load / 4)
    force = np.exp(load) * float(top.c33) / radius
    case = {"material": top, "base": base, "punch": punch, "profile": "sphere", "thickness": 1.0}
    rows = {"radius": xr.DataArray(radius.ravel(), dims="case"), "force": xr.DataArray(force.ravel(), dims="case")}
    answer = solve(case | rows | {"magnetic": "insulating"})
    values = {name: answer[name].values.reshape(shape) for name in (*_LOGARITHMS, *_SIGNED, "voltage")}
    shown = {name: np.log(values[name]) for name in _LOGARITHMS} | {name: values[name] for name in _SIGNED}
    charge = values["charge_per_force"] * force
    shown["charge_ratio"] = values["voltage"] * values["capacitance"] / charge
    return {
        "range": [load_ends.tolist(), size_ends.tolist()],
        "series": {name: _rows(numbers, precision, name in _LOGARITHMS) for name, numbers in shown.items()},
    }


def _rows(values: Array, precision: float, logarithms: bool) -> list[list[float]]:
    """Return the coefficients of a function of two variables without the small ones."""
    series = coefficients(np.asarray(coefficients(values).T)).T
    least = precision * (1.0 if logarithms else float(np.abs(series).max()))
    rows = [_short(row, least / max(float(np.abs(row).max()), least)) for row in series]
    last = max(place for place, row in enumerate(rows) if row)
    return rows[: last + 1]


def _table(top: Material, base: Material, punch: str, precision: float, *shown: int) -> dict[str, Any]:
    """Return units and series of a film, to a share of their largest coefficients; pressures at the `shown` samples."""
    film = Stack([Layer(top, 1.0)], base)
    kinds = [PointKind(film, (True, True), shape, _compliance(punch)) for shape in _SHAPES]
    rows = [_entries(kinds, place, shown) for place in mapped_points(_TABLE_NODES, *np.log(RANGE))]
    loads, pressures = (coefficients(np.array(part)).T for part in zip(*rows, strict=True))
    centre = len(pressures) - len(_CAUSES) - 1  # where the pressure is largest; elsewhere it is drawn
    return {
        "units": kinds[0].scale[1:].tolist(),
        "loads": [_short(series, precision) for series in loads],
        "pressures": [_short(series, precision if k >= centre else _DRAWN) for k, series in enumerate(pressures)],
    }


def _entries(kinds: list[PointKind], place: float, shown: tuple[int, ...]) -> tuple[Array, Array]:
    """Return the layers' contribution at log(a/h): loads and edges (16,), and pressures (sample * 4,)."""
    number = int(number_of(np.exp(np.array([place])))[0])
    loads, pressures = [], []
    for point_kind, causes in zip(kinds, (_CAUSES, _CAUSES[-1:]), strict=True):
        table_window = window(point_kind, number)
        loads.append(table_window.read(np.array([place]))[0, :2][:, _CHANNELS][:, :, causes])
        places = np.full(len(causes), place)
        added = table_window.tractions(places, np.eye(4)[causes])[:, 0]
        pressures.append(-added @ added_forms(SAMPLES[list(shown)], added.shape[-1]).T)
    return np.concatenate(loads, axis=-1).ravel(), np.concatenate(pressures).T.ravel()


def _short(series: Array, precision: float) -> list[float]:
    """Return a series without its tail of coefficients below a share of the largest, to as many digits."""
    large = np.flatnonzero(np.abs(series) > precision * np.max(np.abs(series)))
    ends = int(large[-1]) + 1 if large.size else 0
    places = int(np.ceil(-np.log10(precision * np.max(np.abs(series))))) + 1 if ends else 0
    return [round(float(value), places) for value in series[:ends]]


def _compliance(punch: str) -> float:
    if punch == RIGID_PUNCH:
        return 0.0
    known = find_punch(punch)
    return float(Punch.isotropic(known.modulus, known.poisson).compliance)


def write(names: Iterable[str] = FILMS) -> None:
    """Compute the tables of some films and write all films anew."""
    known = {(table["film"], table["punch"]): table for table in (_stored() if _STORED.exists() else [])}
    known |= {(name, punch): solved(name, punch) for name in names for punch in PUNCHES}
    ordered = [known[name, punch] for name in FILMS for punch in PUNCHES if (name, punch) in known]
    lines = [json.dumps(table, separators=(",", ":"), allow_nan=False, ensure_ascii=False) for table in ordered]
    _STORED.write_text("[\n" + ",\n".join(lines) + "\n]\n", encoding="utf-8")


if __name__ == "__main__":
    write(sys.argv[1:] or FILMS)
