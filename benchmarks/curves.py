"""Largest stresses of films by their curves and by themselves, on the same cases: errors on fresh exact maxima, times.

The film is of one thickness; its five groups are the inputs (load, T/P and J/P at a radius). A table of the solver
holds every load of a composition and a friction; its search is the exact answer.
"""

import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

import solver
from approximation.arrays import Array
from benchmarks.timing import least, timed
from solver.curves import FOLLOWS, REGIONS, described
from solver.halfplane.profile import Profile
from solver.line.contact import FilmContact
from solver.line.peaks import PeakTable
from solver.line.table import table
from solver.stack.layers import RIGID, Layer, Stack
from surrogate import GridGP, Input
from surrogate.transforms.curves.basis import Curves, Largest
from surrogate.transforms.curves.curvegp import CurveGP

THICKNESS, RADIUS = 1e-3, 1.0
BASES = {"rigid": (RIGID, 100.0, 6.0), "steel": ("steel", 70.0, 11.0)}
#: Tables, then loads and charges of each, and the grids of levels that are compared.
GRIDS = {"interface": ((10, 4, 16, 3, 2), (13, 5, 21, 4, 3)), "film": ((9, 4, 16, 2, 2),)}
_OUTPUTS = {
    "interface": ("interface_shear", "interface_shear_position", "interface_tension"),
    "film": ("film_peak_von_mises", "film_peak_principal_tension"),
}
_NODES, _LEAST = 30, 0.04
_PLACES, _TOGETHER = 15, 100


def _inputs(base: str) -> list[Input]:
    """The groups: composition, friction, P R/(h^2 c33), T/P and J/P."""
    return [
        Input("volume_fraction", 0.05, 0.95, "logit"),
        Input("friction", 0.0, 0.6),
        Input("load_group", 1.5e-3, BASES[base][1], "log"),
        Input("charge_per_load", -2e-10, 2e-10),
        Input("flux_per_load", -1e-7, 1e-7),
    ]


def _solved(base: str, region: str, place: Sequence[float], G: Array, charges: Array) -> dict[str, Array]:
    """Curves and exact maxima over P/h, (case, ...), of one composition and friction; G (case,), charges (case, 2)."""
    fraction, friction = place
    material = solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), fraction)
    body = BASES[base][0]
    stack = Stack((Layer(material, THICKNESS),), RIGID if base == "rigid" else solver.find(body))
    whole = table(stack, friction, least=_LEAST, most=BASES[base][2], nodes=_NODES, accuracy=1.0)
    load = G * THICKNESS**2 * material.c33 / RADIUS
    contact = FilmContact(
        whole, Profile.cylinder(np.full(G.shape, RADIUS)), load, load[:, None] * charges, np.ones(G.shape)
    )
    of, unit = PeakTable(whole), load / THICKNESS
    fields = of.curves(contact, region)
    found = {name: curve if name.endswith("position") else curve / unit[:, None] for name, curve in fields.items()}
    found |= {"mean_pressure": THICKNESS / (2 * contact.half_width), "half_length": contact.half_width}
    peaks = of.peaks(contact, region)
    exact = {name: peaks[name] if name.endswith("position") else peaks[name] / unit for name in _OUTPUTS[region]}
    return found | exact


def _grid(base: str, region: str, counts: Sequence[int]) -> xr.Dataset:
    """Curves and maxima on the levels of the groups."""
    axes = [axis.levels(count) for axis, count in zip(_inputs(base), counts, strict=True)]
    loads, *charges = (values.ravel() for values in np.meshgrid(*axes[2:], indexing="ij"))
    parts = [
        _solved(base, region, (v, f), loads, np.stack(charges, -1)) for v in axes[0].tolist() for f in axes[1].tolist()
    ]
    names = [input_.name for input_ in _inputs(base)]
    data = xr.Dataset(coords=dict(zip(names, axes, strict=True)))
    for name in parts[0]:
        whole = np.stack([part[name] for part in parts])
        data[name] = ([*names, *[f"{region}_point"] * (whole.ndim - 2)], whole.reshape(*counts, *whole.shape[2:]))
    return data


def _fresh(base: str, region: str, places: int, together: int, seed: int) -> xr.Dataset:
    """Random cases, some at a time of one composition and friction, over `case`."""
    random, groups = np.random.default_rng(seed), _inputs(base)
    columns: dict[str, list[Array]] = {}
    # few as the places are, each lies in a part of its own of either axis
    spread = [2 * (random.permutation(places) + random.uniform(size=places)) / places - 1 for _ in range(2)]
    for k in range(places):
        u = random.uniform(-1, 1, (5, together))
        u[:2] = np.array(spread)[:, k, None]
        values = [axis.from_unit(row) for axis, row in zip(groups, u, strict=True)]
        part = _solved(base, region, (float(values[0][0]), float(values[1][0])), values[2], np.stack(values[3:], -1))
        part |= {axis.name: value for axis, value in zip(groups, values, strict=True)}
        for name, value in part.items():
            columns.setdefault(name, []).append(value)
    return xr.Dataset(
        {name: (("case", f"{region}_point")[: own[0].ndim], np.concatenate(own)) for name, own in columns.items()}
    )


def _model(base: str, region: str, error: float) -> CurveGP:
    """The model of a region, not fitted."""
    here = REGIONS[region]
    largest: dict[str, Largest] = {}
    for name in _OUTPUTS[region]:
        peak = FOLLOWS[name]
        place = here.fields.index(peak.place) if peak.place else -1
        largest[name] = Largest(0, peak.measure, place)
    # over P/h the stresses of the interface have no size of their own
    sizes = tuple("" if size == "load_over_thickness" else size for size in here.sizes)
    curves = Curves(tuple(described(region)), sizes, here.panels, f"{region}_point")
    return CurveGP(
        lambda names: GridGP(inputs=_inputs(base), compression=1e-2 * error),
        [curves],
        largest,
        _OUTPUTS[region],
        error=error,
    )


def _compared(base: str, region: str, counts: Sequence[int], cases: xr.Dataset, error: float) -> dict[str, Any]:
    """Errors of the curves' maxima and of the maximum itself, learnt on the same grid, and times."""
    data, solved_in = timed(lambda: _grid(base, region, counts))
    curves, fitted_in = timed(lambda: _model(base, region, error).fit(data))
    names = list(_OUTPUTS[region])
    plain = GridGP(inputs=_inputs(base), outputs=names).fit(data[names])
    X = np.stack([cases[input_.name].values for input_ in _inputs(base)], axis=1)
    exact = np.stack([cases[name].values for name in names], axis=1)
    spread = np.ptp(exact, axis=0)
    out: dict[str, Any] = {
        "cases": int(np.prod(counts)),
        "tables": counts[0] * counts[1],
        "rank": len(curves.bases_[0].vectors),
        "data set [s]": solved_in.processor,
        "fit [s]": fitted_in.processor,
        "a query in blocks [us]": 1e6 * least(lambda: curves.predict_array(X)).processor / len(X),
        "a query alone [us]": 1e6 * least(lambda: curves.predict_array(X[:1]), 20).processor,
    }
    for kind, answers in (("curves", curves.predict_array(X)), ("maximum", plain.predict_array(X))):
        away = np.abs(answers - exact)
        for k, name in enumerate(names):
            out[f"{name}, {kind}"] = {
                "over range": float(away[:, k].max() / spread[k]),
                "90 %": float(np.quantile(away[:, k], 0.9) / spread[k]),
                "relative": float((away[:, k] / np.abs(exact[:, k])).max()),
            }
    return out


def measure() -> dict[str, Any]:
    """Errors and times of every base, region and grid."""
    measured: dict[str, Any] = {}
    for base in BASES:
        for region, grids in GRIDS.items():
            cases = _fresh(base, region, _PLACES, _TOGETHER, 1)
            for counts, error in zip(grids, (1e-5, 1e-6), strict=False):
                measured[f"{base}, {region}, {np.prod(counts)} cases"] = _compared(base, region, counts, cases, error)
    return measured


if __name__ == "__main__":
    print(measure(), file=sys.stdout)
