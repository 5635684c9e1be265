"""Surrogates of a study's largest stresses by the curves that they follow from."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import xarray as xr

from solver.curves import FOLLOWS, REGIONS, described
from solver.names import ALL_QUANTITIES
from storage.netcdf import read_whole
from surrogate.face.model import GaussianProcess
from surrogate.gp.gridgp import GridGP
from surrogate.transforms.curves.basis import Curves, Largest
from surrogate.transforms.curves.curvegp import CurveGP
from surrogate.transforms.groupedgp import GroupedGP
from surrogate.transforms.groups import Grouping, Scaling
from workflow.dataset import factorial, similar
from workflow.study import categories
from workflow.study.categories import output
from workflow.study.model import Study

_SHARE = 1e-2  # share of the tolerance for the basis of the curves and the compression of its scores


def model(study: Study, compression: float, by: Grouping | None = None) -> CurveGP:
    """Return the process, not fitted, of a study that learns curves."""
    curves: list[Curves] = []
    largest: dict[str, Largest] = {}
    attrs: dict[str, dict[str, str]] = {}
    for combination in study.combinations:
        for name in study.regions:
            region = REGIONS[name]
            fields = tuple(output(f"{name}_{field}", combination) for field in region.fields)
            sizes = tuple(output(size, combination) if size else "" for size in region.sizes)
            curves.append(Curves(fields, sizes, region.panels, f"{name}_point"))
            for quantity, peak in FOLLOWS.items():
                if peak.region == name and quantity in study.outputs:
                    place = region.fields.index(peak.place) if peak.place else -1
                    output_name = output(quantity, combination)
                    largest[output_name] = Largest(len(curves) - 1, peak.measure, place)
                    names = f", {categories.named(combination)}" if combination else ""
                    described_peak = ALL_QUANTITIES[quantity]
                    words = described_peak.long_name + names
                    attrs[output_name] = {"units": described_peak.units, "long_name": words}
    inputs = factorial.inputs(study)
    scalings = dict(by.scalings) if by else {}
    for combination in study.combinations if by else ():
        scalings |= {
            output(size, combination): Scaling(similar.scale(study, size), logarithm=1) for size in _sizes(study)
        }

    def smooth(names: Sequence[str]) -> GaussianProcess:
        if by is None:
            return GridGP(inputs, names, compression=compression)
        scaled = replace(by, scalings={name: scalings.get(name, Scaling()) for name in names})
        return GroupedGP(scaled, compression=compression)

    error = _SHARE * study.validation.tolerance
    return CurveGP(smooth, curves, largest, study.output_names, attrs, logarithms=by is None, error=error)


def joined(study: Study, quantities: xr.Dataset, slabs: Sequence[str]) -> xr.Dataset:
    """Return the quantities of the factorial, with the curves of its slabs if the study learns any."""
    if not study.regions:
        return quantities
    parts = [read_whole(Path(slab), names=_names(study)) for slab in slabs]
    first = str(next(iter(study.axes)))
    return quantities.merge(xr.concat(parts, first, data_vars="all"), combine_attrs="override")


def given(study: Study, data: xr.Dataset) -> bool:
    """Return whether data have the curves that a study learns, if it learns any."""
    return bool(study.regions) and set(_names(study)) <= data.keys()


def training_data(study: Study, data: xr.Dataset) -> xr.Dataset:
    """Return the surrogate's training data: the study's outputs, and the curves that the data have."""
    outputs = factorial.training_data(study, data)
    if not given(study, data):
        return outputs
    return outputs.merge(categories.apart(data, study.categories, _names(study)), combine_attrs="override")


def _names(study: Study) -> list[str]:
    """Return the learned variables of the slabs that are no quantities: sizes, and fields of all regions."""
    return [*_sizes(study), *(name for region in study.regions for name in described(region))]


def _sizes(study: Study) -> list[str]:
    return list(dict.fromkeys(size for region in study.regions for size in REGIONS[region].sizes if size))
