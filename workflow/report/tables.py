"""Tables of the page, from the files of a run."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from solver.described import Contact
from solver.fields import EVERY_FIELD
from solver.names import ALL_QUANTITIES
from storage.netcdf import read_whole
from surrogate.use.validation import ideal
from workflow.dataset import factorial
from workflow.language import titles
from workflow.report import sentences
from workflow.report.verification import findings
from workflow.study import coupling
from workflow.study.categories import titled
from workflow.study.datum import meaning
from workflow.study.model import Study
from workflow.study.sections import CHECK_GROUPS

#: Quantities in the summary of a parametric study.
CHANGED: dict[Contact, tuple[str, ...]] = {
    "line": ("peak_pressure", "trailing_tension", "depth", "voltage"),
    "point": ("contact_radius", "peak_pressure", "depth", "voltage", "charge_per_force"),
}
_JUDGED = ("coverage", "worst_decile_coverage", "worst_corner_coverage", "pit_distance", "crps")
_INTERVALS = (*_JUDGED, *(f"raw_{key}" for key in _JUDGED), "raw_max_error")


def verification(folder: Path) -> dict[str, Any]:
    """Return the checks of every group."""
    groups = findings([folder / "verification" / f"{name}.json" for name in CHECK_GROUPS])
    checks = [check for group in groups for check in group["checks"]]
    return {
        "groups": {
            name: group | {"says": sentences.checks(group)} for name, group in zip(CHECK_GROUPS, groups, strict=True)
        },
        "checks": len(checks),
        "green": sum(check["passed"] for check in checks),
        "timings": [timing for group in groups for timing in group["timings"]],
    }


def dataset(folder: Path, card: Mapping[str, Any], quantities: Collection[str]) -> dict[str, Any]:
    """Return the range of every quantity that the page shows, and the size of the data set."""
    data = read_whole(folder / "quantities.nc")
    rows = [
        {
            "name": str(name),
            "units": ALL_QUANTITIES[str(name)].units,
            "long_name": meaning(str(name), card["on_datum"]),
            "low": float(array.min()),
            "high": float(array.max()),
        }
        for name, array in data.data_vars.items()
        if name in quantities
    ]
    places = sum(file["levels"] for file in card["files"])  # of a cross approximation
    return {
        "rows": rows,
        "slabs": len(card["files"]),
        "fields": sum(name in EVERY_FIELD for name in card["variables"]),
        "bytes": card["bytes"],
        "cases": card["cases"],
        "places": places,
    }


def surface(path: Path) -> list[dict[str, Any]]:
    """Return errors and intervals of the fields under the punch."""
    return _rows(read_whole(path), "output", ("max_error", "rmse", *_INTERVALS))


def _rows(data: xr.Dataset, dim: str, keys: Sequence[str]) -> list[dict[str, Any]]:
    """Return numbers along a dimension, with a row for each ``name`` in it."""
    columns = {key: data[key].transpose(dim).values.tolist() for key in keys}
    return [
        {"name": str(name), **{key: float(column[place]) for key, column in columns.items()}}
        for place, name in enumerate(data[dim].values)
    ]


def levels(path: Path) -> dict[str, Any]:
    """Return the pilots' evidence for the levels of the factorial."""
    data = read_whole(path)
    errors = data["predicted_error"]
    rows = [
        {
            "name": str(name),
            **{key: int(row[key]) for key in ("levels", "pilot_levels", "given", "affine", "extrapolated")},
            "rate": float(row["rate"].max()),
            "error": float(row["interpolation_error"].max()),
            "decider": str(row["output"].values[int(row["interpolation_error"].values.argmax())]),
        }
        for name in data["input"].values
        for row in [data.sel(input=name)]
    ]
    return {"rows": rows, "predicted": float(errors.max()), **data.attrs}


def validation(folder: Path, study: Study) -> dict[str, Any]:
    """Return errors and intervals of every output on the page, on fresh cases, and those of ideal intervals."""
    data = read_whole(folder / "validation.nc").sel(output=coupling.outputs(study))
    tolerance = float(data.attrs["tolerance"])
    of_interpolation = ["baseline_max_error"] if "baseline_max_error" in data else []
    rows = [
        row | {"error": row["max_error"], "baseline": row.get("baseline_max_error")}
        for row in _rows(data, "output", ("max_error", "rmse", "r2", *of_interpolation, *_INTERVALS))
    ]
    worst = max(rows, key=lambda row: row["error"])
    along = data["axis" if "axis" in data.dims else "input"].values
    kinked = [
        {"name": str(name), "along": [str(factor) for factor in along[flags.values > 0]]}
        for name, flags in zip(data["output"].values, data["kinked"], strict=True)
        if (flags.values > 0).any()
    ]
    levels = [
        {
            "level": float(level),
            **{
                f"{prefix}{end}": float(getattr(data[f"{prefix}level_coverage"].sel(level=level), reduction)())
                for prefix in ("", "raw_")
                for end, reduction in (("low", "min"), ("high", "max"))
            },
        }
        for level in data["level"].values
    ]
    before = max(row["raw_max_error"] for row in rows)
    box = {input_.name: input_ for input_ in factorial.inputs(study)}
    return {
        "kinked": kinked,
        "rows": rows,
        "levels": levels,
        "ideal": ideal(box, {name: data[name] for name in box}, data.sizes["output"]),
        "tolerance": tolerance,
        "logarithms": str(data.attrs.get("logarithms", "")).split("; ") if "logarithms" in data.attrs else [],
        "worst": worst,
        "uncorrected": before if any(row["raw_max_error"] != row["error"] for row in rows) else None,
        "crps_over_raw": float((data["crps"] / data["raw_crps"]).median()),
        "cases": data.sizes["case"],
    }


def effects(study: Study, folder: Path) -> list[dict[str, Any]]:
    """Least and largest value of a few quantities over the values of each factor of a parametric study."""
    assert study.effects is not None
    rows = []
    for factor, values in study.effects.vary.items():
        data = read_whole(folder / "fields" / f"effect_{factor}.nc")
        words = [value.replace("_", " ") if isinstance(value, str) else titles.value(factor, value) for value in values]
        changed = CHANGED[study.kind.contact]
        known = [name for name in changed if name in data and factor in data[name].dims]  # not every punch has all
        selected = {name: data[name].isel({factor: slice(len(values))}) for name in known}
        spans = {
            name: (float(values.min()), float(values.max()))
            for name, values in selected.items()
            if values.notnull().all()
        }
        over = ", ".join(words) if isinstance(values[0], str) else f"{words[0]} to {words[-1]}"
        rows.append({"name": factor, "over": over, "spans": spans})
    return rows


def sobol(folder: Path, quantities: Sequence[str]) -> list[dict[str, Any]]:
    """Return total Sobol' indices of every output on the page, by input."""
    totals = read_whole(folder / "sensitivity.nc")["total"].sel(output=list(quantities)).transpose("output", "input")
    inputs = [str(name) for name in totals["input"].values]
    return [
        {"title": titled(name), "totals": dict(zip(inputs, row, strict=True))}
        for name, row in zip(quantities, totals.values.tolist(), strict=True)
    ]


def readout(name: str, path: Path) -> dict[str, Any]:
    """Return coverage and width of the intervals of a read-out."""
    data = read_whole(path)
    rows = _rows(data, "factor", ("coverage", "width", "left"))
    return {"name": name, "rows": rows, "cases": data.sizes["case"]}


def signal(folder: Path) -> dict[str, float]:
    """Return the numbers of a press in time."""
    data = read_whole(folder / "signal.nc")
    numbers = {str(name): float(value) for name, value in data.data_vars.items() if not value.dims}
    return numbers | {"force": float(data["force"].max())}
