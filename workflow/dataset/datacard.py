"""The data card of a study: content, size and cost of its data set."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from storage.blocks import pooled
from storage.described import unscaled
from storage.netcdf import MAX_BYTES
from storage.sealed import check_seal
from workflow.dataset import similar
from workflow.dataset.batches import PLACE
from workflow.study import datum, grouped
from workflow.study.model import Study


def card(study: Study, name: str, slabs: Sequence[Path], benchmarks: Sequence[Path]) -> dict[str, Any]:
    """Return the card as plain data, from the slabs' headers and the times of their jobs."""
    files = [_file(path, PLACE if study.crossed else next(iter(study.axes))) for path in slabs]
    variables = {key: _merged([file["variables"][key] for file in files]) for key in files[0]["variables"]}
    seconds = [_seconds(path) for path in benchmarks if path.is_file()]
    return {
        "title": study.title,
        "study": name,
        "cases": study.block * sum(file["levels"] for file in files) if study.crossed else study.cases,
        "crossed": study.crossed,
        "factors": {key: axis.model_dump() for key, axis in study.factors.items()},
        "groups": _groups(study),
        "categories": study.categories,
        "fixed": study.fixed,
        "body": [layer.words() for layer in study.body],
        "datum": datum.length(study),
        **({"absolute": True} if study.kind.datum == "absolute" else {}),
        "on_datum": sorted(datum.hanging(study) & variables.keys()),
        "bytes": sum(file["bytes"] for file in files),
        "bytes_unpacked": sum(
            variable["count"] * np.dtype(variable["type"]).itemsize for variable in variables.values()
        ),
        "seconds_of_jobs": sum(seconds) if len(seconds) == len(slabs) else None,
        "files": [{key: file[key] for key in ("name", "levels", "bytes", "sha256")} for file in files],
        "variables": variables,
        "positions": files[0]["positions"],
    }


def markdown(card: Mapping[str, Any]) -> str:
    """Return the card as Markdown."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # slow to import, and most readers need none

    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=False,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    names_by_scale: dict[str, list[str]] = {}
    for name, powers in card["groups"].get("scales", {}).items():
        words = " ".join(f"{factor}^{power:g}" for factor, power in powers.items()) or "1"
        names_by_scale.setdefault(words, []).append(name)
    return environment.get_template("datacard.md.j2").render(card, names_by_scale=names_by_scale)


def _groups(study: Study) -> dict[str, Any]:
    """Return the stored axes of a study with groups and the rule that gives each case; empty without groups."""
    if not study.groups:
        return {}
    axes = {
        name: {
            **study.axes[name].model_dump(),
            "product": product.text,
            "powers": dict(product.powers),
            "units": product.units,
        }
        for name, product in study.products.items()
    }
    leads = grouped.leads(study.products.values(), study.factors)
    held = {name: value for name, value in datum.inner(study).items() if name not in leads.values()}
    scales = {name: similar.scale(study, name) for name in study.quantities}
    return {"axes": axes, "varied": leads, "held": held, "scales": scales, "log_of_datum_added": sorted(study.added)}


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
                name: {
                    "type": str(variable.dtype),
                    "count": variable.size,
                    "attributes": _attributes(variable),
                }
                for name, variable in file.variables.items()
                if "actual_range" in variable.ncattrs()
            },
        }


def _attributes(variable: "netCDF4.Variable[Any]") -> dict[str, Any]:
    attrs = {key: np.asarray(variable.getncattr(key)).tolist() for key in variable.ncattrs()}
    return {str(key): value for key, value in unscaled(attrs).items()}


def _merged(parts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return one variable from its parts in several files, with its statistics; empty parts count for nothing."""
    parts = [part for part in parts if part["count"]]
    counts, attrs = [part["count"] for part in parts], [part["attributes"] for part in parts]
    return {"type": parts[0]["type"], "count": sum(counts), "attributes": {**attrs[0], **pooled(counts, attrs)}}


def _seconds(path: Path) -> float:
    with path.open(encoding="utf-8", newline="") as file:
        return sum(float(row["s"]) for row in csv.DictReader(file, delimiter="\t"))
