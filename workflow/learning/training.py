"""Training and validation of the surrogate on exact cases."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from approximation.arrays import Array, Flags
from storage.described import described
from surrogate import CrossGP, GaussianProcess, GridGP, GroupedGP
from surrogate.data.inputs import unit_coordinates
from surrogate.data.meanings import MEANINGS, SOURCE
from surrogate.data.points import EVEN
from surrogate.face.region import Region
from surrogate.gp import imputation
from surrogate.intervals.sharing import sharing
from surrogate.levels import counts, lines
from surrogate.transforms.transformed import groups_of
from surrogate.use import feasibility, validation
from workflow.dataset import batches, factorial, holes
from workflow.learning import curves
from workflow.run.joblog import log
from workflow.study.model import Study
from workflow.study.refusals import REASON, REFUSAL

#: Error allowed to the compressed mean of a cross approximation, of its tolerance.
COMPRESSION = 0.02


def compression(study: Study) -> float:
    """Error allowed to the compressed mean: far below the tolerance, but no smaller, since lower ranks answer faster.

    A film has two dozen outputs on each base; with a smaller error the ranks of their train would be some hundreds.
    """
    allowed = 1e-3 * study.validation.tolerance
    return allowed if study.kind.tabled else min(1e-9, allowed)


def fit(study: Study, quantities: xr.Dataset) -> GaussianProcess:
    """Gaussian process of the study's outputs on its factorial, or on what a cross approximation asked for of it."""
    data, by = imputed(study, curves.training_data(study, quantities)), None
    if study.groups:
        data = factorial.with_factors(study, data)
        by = factorial.grouping(study, data)
    if curves.given(study, quantities):  # some outputs follow from them
        model: GaussianProcess = curves.model(study, compression(study), by)
    elif by is not None:
        crossing = (lambda names: _crossing(study)) if study.crossed else None
        model = GroupedGP(by, compression=compression(study), process=crossing)
    else:
        model = _crossing(study) if study.crossed else process(study, study.output_names)
    model.made_from_ = study.physics
    if study.surrogate.level is not None:
        model.level_ = study.surrogate.level
    return model.fit(data)


def process(study: Study, outputs: Sequence[str]) -> GridGP:
    """The process of some outputs on the study's factorial, not fitted."""
    return GridGP(factorial.inputs(study), outputs, compression=compression(study))


def _crossing(study: Study) -> CrossGP:
    """The cross approximation of a study, which asks for places before it is fitted."""
    return CrossGP(
        factorial.axis_inputs(study),
        {name: axis.levels or 0 for name, axis in study.axes.items()},
        study.crossed,
        study.validation.tolerance,
        study.output_names,
        COMPRESSION * study.validation.tolerance,
        most=study.dataset.budget // study.block,
    )


def places(study: Study, solved: Sequence[xr.Dataset]) -> xr.Dataset:
    """Return the cases that a cross approximation needs after the slabs of its batches so far: see `CrossGP.ask`."""
    if not solved:
        return _crossing(study).ask(None)
    known = factorial.training_data(study, batches.joined(solved))
    return _crossing(study).ask(
        factorial.scaled(study, known, factorial.grouping(study, known) if study.groups else None)
    )


def validate(study: Study, quantities: xr.Dataset, cases: xr.Dataset, model: GaussianProcess) -> xr.Dataset:
    """Errors on random exact cases that the model never saw, beside plain tensor Chebyshev interpolation of a grid."""
    points, cases, refused = answered(study, cases, model)
    cases, quantities = (
        factorial.training_data(study, cases),
        imputed(study, factorial.training_data(study, quantities)),
    )
    by = groups_of(model)
    reduced = factorial.scaled(study, quantities, by)
    if study.crossed:
        decays = lines.decays(_crossing(study), reduced)
    else:
        decays = counts.decays(reduced, factorial.axis_inputs(study), study.output_names)
    if by is not None:
        quantities = factorial.with_factors(study, quantities)
    predicted = model.predict(points)
    table = validation.validate(model, cases, None if study.crossed else quantities)
    names = study.output_names
    stacked = {
        "exact": cases[names].to_dataarray("output"),
        "predicted": predicted[names].to_dataarray("output"),
        "std": predicted[[f"{name}_std" for name in names]].to_dataarray("output"),
    }
    out = table.assign({name: (("output", "case"), array.values) for name, array in stacked.items()})
    out = out.assign_coords({name: ("case", array.values, array.attrs) for name, array in points.items()})
    evidence = counts.evidence(decays, {name: axis.levels or 0 for name, axis in study.axes.items()})
    out = out.assign(evidence.rename(input="axis") if study.groups else evidence)
    out = out.assign_coords(units=("output", [cases[name].attrs["units"] for name in names]))
    table = described(out, "errors of the surrogate on exact cases", SOURCE, MEANINGS)
    logs = [] if by is None else [name for name, scaling in by.scalings.items() if scaling.logarithm]
    attributes = {"logarithms": "; ".join(logs)} if logs else {}
    return table.assign_attrs(tolerance=study.validation.tolerance, **attributes, **refused)


def answered(
    study: Study, cases: xr.Dataset, model: GaussianProcess
) -> tuple[dict[str, xr.DataArray], xr.Dataset, dict[str, int]]:
    """Factors and cases of a sample that solver and model answer, and how many of the others there are of each kind."""
    if REFUSAL not in cases and model.region_ is None:
        return {name: cases[name] for name in study.factors}, cases, {}
    refused = holes.refused(cases, ["case"])
    inside = model.has_answers(np.stack([cases[name].values for name in study.factors], -1))
    counts = {
        "drawn": refused.size,
        "refused": int(refused.sum()),
        "refused_inside": int((refused & inside).sum()),
        "answered_outside": int((~refused & ~inside).sum()),
    }
    left = cases.drop_vars([REFUSAL, REASON], errors="ignore").isel(case=~refused & inside)
    return {name: left[name] for name in study.factors}, left, counts


def calibrated(study: Study, model: GaussianProcess, quantities: xr.Dataset, cases: xr.Dataset) -> GaussianProcess:
    """Model with intervals calibrated on held-out cases, and with its region where cases are refused."""
    if REFUSAL in cases or REFUSAL in quantities:
        model.region_ = _region(study, model, quantities, cases)
        cases = answered(study, cases, model)[1]
    return model.calibrate(curves.training_data(study, cases))


def _region(study: Study, model: GaussianProcess, quantities: xr.Dataset, cases: xr.Dataset) -> Region | None:
    """Return the region in which the model answers, from the factorial's places and the cases for calibration.

    None is all of the box: every case that is refused lies beyond it, where groups are at their ends together.
    """
    axes = list(study.axes)
    grid = factorial.with_factors(study, quantities) if study.groups else quantities
    nodes = xr.broadcast(*(grid[name] for name in study.factors), xr.DataArray(holes.refused(grid, axes), dims=axes))
    columns = [column.transpose(*axes).values.ravel() for column in nodes]
    X = np.concatenate([np.stack(columns[:-1], -1), np.stack([cases[name].values for name in study.factors], -1)])
    refused = np.concatenate([columns[-1], holes.refused(cases, ["case"])]).astype(bool)
    texts = [text for data, dims in ((grid, axes), (cases, ["case"])) for text in holes.reasons(data, dims)]
    t = unit_coordinates(model.inputs_, X)
    inside = np.asarray((np.abs(t) <= 1 + 1e-9).all(axis=0))  # the stored cases of groups may lie beyond the box
    texts = [text for text, chosen in zip(texts, inside[refused].tolist(), strict=True) if chosen]
    if not texts:
        return None
    even = np.zeros(len(X), dtype=bool)
    even[columns[-1].size :] = np.asarray(cases[EVEN].values) > 0 if EVEN in cases else True
    shared = sharing(t[:, columns[-1].size :])
    groups = np.concatenate([np.arange(columns[-1].size), columns[-1].size + shared])
    reasons = list(dict.fromkeys(texts))
    which = np.array([reasons.index(text) for text in texts], dtype=np.intp)
    region = feasibility.learn(t[:, inside], refused[inside], even[inside], groups[inside], which, reasons)
    log.info("%.2g %% of the cases are refused; %s", 100 * region.refused, "; ".join(reasons[:3]))
    return region


def imputed(study: Study, data: xr.Dataset) -> xr.Dataset:
    """Return training data with NaN filled in; data without NaN, and of no factorial, are unchanged.

    The kernels are fitted to the quantities, and fill in curves too. Of a study with groups, quantities of one sign are
    filled in by their logarithms, so that they keep the sign.
    """
    if study.crossed:
        return data
    holes = {str(name): _missing(study, array) for name, array in data.data_vars.items()}
    if not any(flags.any() for flags in holes.values()):
        return data
    axes = list(study.axes)
    plain = {str(name): array.transpose(*axes) for name, array in data.data_vars.items() if set(array.dims) == {*axes}}
    signs = {name: _sign(array.values) if study.groups else 0 for name, array in plain.items()}
    bent = xr.Dataset({name: np.log(array * signs[name]) if signs[name] else array for name, array in plain.items()})
    coords = {name: data[name].values for name in axes}
    filled, model = imputation.filled(
        lambda: GridGP(factorial.axis_inputs(study)),
        bent.assign_coords(coords),
        {name: holes[name] for name in plain},
    )
    values = {name: np.exp(filled[name].values) * signs[name] if signs[name] else filled[name].values for name in plain}
    return data.assign(
        {name: (plain[name].dims, array, data[name].attrs) for name, array in values.items()}
        | {
            str(name): (array.dims, _filled(model, array, axes, holes), array.attrs)
            for name, array in data.data_vars.items()
            if name not in plain
        }
    )


def _missing(study: Study, array: xr.DataArray) -> Flags:
    """Return whether each place of the axes is missing."""
    extra_dims = [dim for dim in array.dims if dim not in study.axes]
    return np.asarray(array.isnull().any(extra_dims).transpose(*study.axes).values)


def _filled(model: GridGP, array: xr.DataArray, axes: list[str], holes: Mapping[str, Flags]) -> Array:
    """Curves with what the process expects where they are missing."""
    ordered = array.transpose(*axes, ...)
    values, flags = ordered.values.copy(), holes[str(array.name)]
    if flags.any():
        columns = values.reshape(*flags.shape, -1)
        offset = columns[~flags].mean(axis=0)
        columns[flags] = imputation.expected(model.factors_, columns - offset, flags) + offset
        values = columns.reshape(values.shape)
    return np.asarray(xr.DataArray(values, dims=ordered.dims).transpose(*array.dims).values)


def _sign(values: Array) -> int:
    known = values[~np.isnan(values)]
    return int(np.sign(known[0])) if (known > 0).all() or (known < 0).all() else 0
