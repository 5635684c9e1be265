"""The parametric study: exact cases of one factor at a time about a baseline, along the surface and inside."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

import solver  # whose maps of contacts in space are slow to import, and few studies have one
from solver import solve, solve_interior
from solver.body import HALF_PLANE
from solver.fields import FIELDS, POINT_FIELDS
from solver.names import FACTORS, OF_A_FILM
from workflow.study.model import Study
from workflow.study.sections import Effects

#: Quantities that are shown over the random surfaces of a rough sphere.
SPREAD = ("peak_pressure", "charge_per_force", "depth")
_CELLS = 121  # of a map along each side, as in a figure of 4 cm


def effect(study: Study, factor: str) -> xr.Dataset:
    """Return quantities over the values of one factor, behind a film's the half-plane, and fields over position."""
    assert study.effects is not None  # the rules are of studies that have them
    positions = study.effects.positions.values()
    solved = partial(solve, positions=positions, materials=study.own_materials, phases=study.phases)
    out = _beside_half_plane(study.effects, factor, study.effects.case(factor), solved)
    fields = [name for name in FIELDS | POINT_FIELDS if name in out]
    return out.assign_attrs(title=f"effect of {factor}", fields=" ".join(fields))


def together(sweeps: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """Return effects about one baseline in one data set, over (case, position); every case has every factor."""
    parts = [
        data.drop_indexes(factor)
        .rename_dims({factor: "case"})
        .reset_coords()
        .assign(varied=("case", [factor] * data.sizes[factor]))
        for factor, data in sweeps.items()
    ]
    whole = xr.concat(parts, "case", data_vars="all", join="override", combine_attrs="drop_conflicts")
    whole["varied"].attrs |= {"units": "1", "long_name": "factor that varies; all others are at the baseline"}
    factors = {str(name) for data in sweeps.values() for name in data.coords} & {str(name) for name in whole.data_vars}
    return whole.set_coords([*sorted(factors), "varied"]).assign_attrs(title=f"effects of {', '.join(sweeps)}")


def interior(study: Study, factor: str) -> xr.Dataset:
    """Return fields below the punch over (factor, y, x) at the factor's first, middle and last value, as `effect`."""
    assert study.effects is not None
    shown, case = study.effects.interior, study.effects.case(factor)
    assert shown is not None
    case[factor] = _few(study.effects.vary[factor])
    x, y = shown.grid()
    solved = partial(solve_interior, x=x, y=y, fields=shown.fields, materials=study.own_materials, phases=study.phases)
    out = _beside_half_plane(study.effects, factor, case, solved)
    return out.assign_attrs(title=f"effect of {factor} inside the body", fields=" ".join(shown.fields))


def spread(study: Study, factor: str) -> xr.Dataset:
    """Return quantities of random surfaces of a rough sphere over (factor, realisation)."""
    assert study.effects is not None
    surfaces = {**study.effects.case(factor), "realisation": np.arange(study.effects.realisations)}
    out = solve(surfaces, materials=study.own_materials, phases=study.phases, outputs=SPREAD)
    return out[[name for name in SPREAD if name in out]].assign_attrs(title=f"effect of {factor} over random surfaces")


def maps(study: Study, factor: str) -> xr.Dataset:
    """Return maps of contacts in space on one window, (factor, y, x), at a factor's first, middle and last value."""
    assert study.effects is not None
    case, values = study.effects.case(factor), _few(study.effects.vary[factor])
    solved = [
        solver.solve_map({**case, factor: value}, materials=study.own_materials, phases=study.phases)
        for value in values
    ]
    # on the widest of their windows
    axes = {axis: np.concatenate([data[axis].values for data in solved]) for axis in ("x", "y")}
    x, y = (np.linspace(points.min(), points.max(), _CELLS) for points in axes.values())
    parts = [
        data.interp(x=x, y=y, method="linear")
        .fillna(0.0)[["contact_pressure", "electric_displacement"]]
        .drop_vars(factor, errors="ignore")
        for data in solved
    ]
    labels = xr.DataArray(values, dims=factor, attrs={"units": FACTORS[factor].units if factor in FACTORS else "1"})
    out = xr.concat(parts, factor, coords="minimal", compat="override").assign_coords({factor: labels})
    return out.assign_attrs(title=f"effect of {factor} on the contact", fields="contact_pressure electric_displacement")


def _few(values: list[Any]) -> list[Any]:
    """Return the first, middle and last value of a factor."""
    return [values[k] for k in dict.fromkeys((0, len(values) // 2, len(values) - 1))]


def _beside_half_plane(
    effects: Effects, factor: str, case: Mapping[str, Any], solved: Callable[[Mapping[str, Any]], xr.Dataset]
) -> xr.Dataset:
    """Return solved cases; behind those of a film the half-plane of the baseline, with the variables of both."""
    out, reference = solved(case), effects.half_plane(factor)
    if reference is None:
        return out
    half_plane = solved(reference)
    held = ", ".join(f"{name} = {value}" for name, value in case.items() if name in OF_A_FILM and name != factor)
    out = out.drop_vars([name for name in OF_A_FILM if name in out.coords and name != factor])
    shared = [name for name in out.data_vars if name in half_plane]
    label = np.array([np.nan if factor in FACTORS else HALF_PLANE.name])  # NaN among numbers
    whole = xr.concat(
        [out[shared], half_plane[shared].expand_dims({factor: label})],
        factor, data_vars="all", coords="minimal", compat="override", join="override",
    )  # fmt: skip
    return whole.assign_attrs(out.attrs, film=held)
