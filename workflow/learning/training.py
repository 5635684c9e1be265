"""Training and validation of the surrogate on exact cases."""

import xarray as xr

from storage.described import described
from surrogate import GaussianProcess, GridGP, GroupedGP
from surrogate.data.meanings import MEANINGS, SOURCE
from surrogate.levels import counts
from surrogate.use import validation
from workflow.dataset import factorial
from workflow.study.model import Study


def compression(study: Study) -> float:
    """Error allowed to the compressed mean: far below the tolerance, and no smaller, since queries cost less so.

    What films have in two dozen outputs on each base would otherwise need ranks of some hundreds.
    """
    allowed = 1e-3 * study.validation.tolerance
    return allowed if study.on_film else min(1e-9, allowed)


def fit(study: Study, quantities: xr.Dataset) -> GaussianProcess:
    """Gaussian process of the study's outputs on its factorial."""
    if study.groups:
        data = factorial.with_factors(study, factorial.learned(study, quantities))
        by = factorial.grouping(study, data)
        grouped = GroupedGP(by, study.surrogate.kernel, compression=compression(study))
        grouped.made_from_ = study.physics
        return grouped.fit(data)
    model = GridGP(study.surrogate.kernel, factorial.inputs(study), study.learned, compression=compression(study))
    model.made_from_ = study.physics
    return model.fit(factorial.learned(study, quantities))


def validate(study: Study, quantities: xr.Dataset, cases: xr.Dataset, model: GaussianProcess) -> xr.Dataset:
    """Errors on random exact cases that the model never saw, beside plain tensor Chebyshev interpolation.

    Parameters
    ----------
    study, quantities, model
        The study, the factorial that the model was trained on, and the model.
    cases
        The sample for validation; neither the training nor the calibration has seen it.

    Returns
    -------
    xarray.Dataset
        ``exact``, ``predicted``, ``std`` over (output, case), the error table over ``output``, the factors over
        ``case``, the decay of the factorial's coefficients, and the tolerance that the study asks for.
    """
    points = {name: cases[name] for name in study.factors}
    cases, quantities = factorial.learned(study, cases), factorial.learned(study, quantities)
    by = model.grouping if isinstance(model, GroupedGP) else None
    decays = counts.decays(factorial.scaled(study, quantities, by), factorial.axis_inputs(study), study.learned)
    if by is not None:
        quantities = factorial.with_factors(study, quantities)
    predicted = model.predict(points)
    table = validation.validate(model, cases, quantities)
    names = study.learned
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
    logs = [] if by is None else [name for name, one in by.scalings.items() if one.logarithm]
    return table.assign_attrs(tolerance=study.validation.tolerance, **({"logarithms": "; ".join(logs)} if logs else {}))
