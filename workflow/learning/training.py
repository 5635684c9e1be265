"""Training and validation of the surrogate on exact cases."""

from collections.abc import Sequence

import xarray as xr

from storage.described import described
from surrogate import CrossGP, GaussianProcess, GridGP, GroupedGP
from surrogate.data.meanings import MEANINGS, SOURCE
from surrogate.levels import counts, lines
from surrogate.transforms.transformed import groups_of
from surrogate.use import validation
from workflow.dataset import batches, factorial
from workflow.learning import curves
from workflow.study.model import Study

#: Allowed error of the compressed mean of a cross approximation over its tolerance.
COMPRESSION = 0.02


def compression(study: Study) -> float:
    """Return the allowed error of the compressed mean: far below the tolerance, but larger ranks answer slower."""
    allowed = 1e-3 * study.validation.tolerance
    # two dozen outputs of a film on each base would need ranks of some hundreds for less
    return allowed if study.kind.tabled else min(1e-9, allowed)


def fit(study: Study, quantities: xr.Dataset) -> GaussianProcess:
    """Fit a Gaussian process of the study's outputs on its factorial, or on the cases of a cross approximation."""
    data, by = curves.training_data(study, quantities), None
    if study.groups:
        data = factorial.with_factors(study, data)
        by = factorial.grouping(study, data)
    if curves.given(study, quantities):  # some outputs follow from them
        model: GaussianProcess = curves.model(study, compression(study), by)
    elif by is not None:
        crossing = (lambda names: _crossing(study)) if study.crossed else None
        model = GroupedGP(by, compression=compression(study), process=crossing)
    else:
        plain = GridGP(factorial.inputs(study), study.output_names, compression=compression(study))
        model = _crossing(study) if study.crossed else plain
    model.made_from_ = study.physics
    if study.surrogate.level is not None:
        model.level_ = study.surrogate.level
    return model.fit(data)


def _crossing(study: Study) -> CrossGP:
    """Return the cross approximation of a study, which asks for places before it is fitted."""
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
    """Return errors on random exact cases, and those of plain tensor Chebyshev interpolation of a grid."""
    points = {name: cases[name] for name in study.factors}
    cases, quantities = (factorial.training_data(study, data) for data in (cases, quantities))
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
    return table.assign_attrs(tolerance=study.validation.tolerance, **attributes)
