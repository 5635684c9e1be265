"""The data card of a study: what its data set holds, how large it is, and what it took to make."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from storage.blocks import STATISTICS
from storage.netcdf import MAX_BYTES
from storage.rootunits import unscaled
from storage.sealed import check_seal
from workflow.dataset.batches import PLACE
from workflow.study import datum
from workflow.study.model import Study


def card(study: Study, name: str, slabs: Sequence[Path], benchmarks: Sequence[Path]) -> dict[str, Any]:
    """The card as plain data, from the slabs' headers and the times of the jobs that made them.

    Parameters
    ----------
    study, name
        The study and its name.
    slabs
        The files of the data set, in order.
    benchmarks
        Snakemake's records of their jobs; where one is missing, the times are not told.
    """
    files = [_file(path, PLACE if study.crossed else next(iter(study.axes))) for path in slabs]
    variables = {one: _merged([file["variables"][one] for file in files]) for one in files[0]["variables"]}
    seconds = [_seconds(path) for path in benchmarks if path.is_file()]
    return {
        "title": study.title,
        "study": name,
        "cases": study.block * sum(file["levels"] for file in files) if study.crossed else study.cases,
        "crossed": study.crossed,
        "factors": {one: axis.model_dump() for one, axis in study.factors.items()},
        "categories": study.categories,
        "fixed": study.fixed,
        "body": [layer.words() for layer in study.body],
        "datum": datum.length(study),
        "on_datum": sorted(datum.hanging(study) & variables.keys()),
        "bytes": sum(file["bytes"] for file in files),
        "bytes_unpacked": sum(one["count"] * np.dtype(one["type"]).itemsize for one in variables.values()),
        "seconds_of_jobs": sum(seconds) if len(seconds) == len(slabs) else None,
        "files": [{key: file[key] for key in ("name", "levels", "bytes", "sha256")} for file in files],
        "variables": variables,
        "positions": files[0]["positions"],
    }


def markdown(card: Mapping[str, Any]) -> str:
    """The card for people."""
    took = card["seconds_of_jobs"]
    size = (
        f"{card['bytes'] / 1e6:,.1f} MB in {len(card['files'])} files, {card['bytes_unpacked'] / 1e6:,.1f} MB unpacked"
    )
    fixed = ", ".join(f"{name} = {value}" for name, value in card["fixed"].items())
    lines = [
        f"# Data card: {card['title']}",
        "",
        f"Study `{card['study']}`: {card['cases']:,} cases, {len(card['positions'])} positions; {size}"
        + (f"; {took:,.1f} s of jobs." if took is not None else "."),
        "",
        "| factor | low | high | levels | scale |",
        "|---|---|---|---|---|",
        *(f"| {n} | {a['low']:g} | {a['high']:g} | {a['levels']} | {a['scale']} |" for n, a in card["factors"].items()),
        "",
        *(
            [
                f"Not all of this factorial: places in {', '.join(crossed)} that a cross approximation asked for, and "
                "all levels of the others at each.  "
            ]
            if (crossed := card["crossed"])
            else []
        ),
        *(f"{name}: {', '.join(names)}.  " for name, names in card["categories"].items()),
        f"Fixed: {fixed or 'nothing'}.  ",
        *(f"Layer {number}: {words}.  " for number, words in enumerate(card["body"], 1)),
        f"{_datum(card)}.",
        "",
        "| variable | unit | minimum | maximum | mean | standard deviation | type | meaning |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name, one in card["variables"].items():
        attrs = one["attributes"]
        low, high = attrs["actual_range"]
        numbers = (low, high, attrs["mean"], attrs["standard_deviation"])
        shown = " | ".join(f"{value:.5g}" for value in numbers)
        lines.append(f"| {name} | {attrs['units']} | {shown} | {one['type']} | {attrs['long_name']} |")
    return "\n".join(lines) + "\n"


def _datum(card: Mapping[str, Any]) -> str:
    """Which variables hang on the datum, and which datum that is."""
    names = [name for name in card["variables"] if name in card["on_datum"]]
    which = "a factor" if card["datum"] is None else f"{card['datum']:g} m"
    return (
        f"Datum: {which}; on this arbitrary length of the potentials hang {', '.join(names) or 'none of the variables'}"
    )


def _file(path: Path, first: str) -> dict[str, Any]:
    digest = check_seal(path, MAX_BYTES, digest=False)
    with netCDF4.Dataset(path, "r") as file:
        return {
            "name": f"{path.parent.name}/{path.name}",
            "levels": file.dimensions[first].size,
            "bytes": path.stat().st_size,
            "sha256": digest,
            "positions": file["position"][:].tolist() if "position" in file.variables else [],
            "variables": {
                name: {"type": str(variable.dtype), "count": int(variable.size), "attributes": _attributes(variable)}
                for name, variable in file.variables.items()
                if "actual_range" in variable.ncattrs()
            },
        }


def _attributes(variable: "netCDF4.Variable[Any]") -> dict[str, Any]:
    found = {key: np.asarray(variable.getncattr(key)).tolist() for key in variable.ncattrs()}
    return {str(key): value for key, value in unscaled(found).items()}


def _merged(parts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """One variable from its parts in several files, statistics and all."""
    attrs = [part["attributes"] for part in parts]
    count = np.array([part["count"] for part in parts], dtype=np.float64)
    means, deviations = (np.array([one[key] for one in attrs]) for key in ("mean", "standard_deviation"))
    mean = float(np.average(means, weights=count))
    variance = float(np.average(deviations**2 + (means - mean) ** 2, weights=count))
    lows, highs = zip(*(one["actual_range"] for one in attrs), strict=True)
    plain = {key: value for key, value in attrs[0].items() if key not in STATISTICS}
    statistics = {"actual_range": [min(lows), max(highs)], "mean": mean, "standard_deviation": variance**0.5}
    return {"type": parts[0]["type"], "count": int(count.sum()), "attributes": {**plain, **statistics}}


def _seconds(path: Path) -> float:
    with path.open(encoding="utf-8", newline="") as file:
        return sum(float(row["s"]) for row in csv.DictReader(file, delimiter="\t"))
