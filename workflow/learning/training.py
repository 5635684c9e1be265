"""Training and validation of the surrogate on exact cases."""

from collections.abc import Sequence

import xarray as xr

from storage.described import described
from surrogate import GaussianProcess, GridGP
from surrogate.data.meanings import MEANINGS, SOURCE
from surrogate.levels import counts
from surrogate.use import validation
from workflow.dataset import factorial
from workflow.learning import curves
from workflow.study.model import Study


def compression(study: Study) -> float:
    """Error allowed to the compressed mean: far below the tolerance, and no smaller, since queries cost less so.

    What films have in two dozen outputs on each base would otherwise need ranks of some hundreds.
    """
    allowed = 1e-3 * study.validation.tolerance
    return allowed if study.on_film else min(1e-9, allowed)


def fit(study: Study, quantities: xr.Dataset) -> GaussianProcess:
    """Gaussian process of the study's outputs on its factorial; where that has curves, of what follows by them."""
    follows = curves.given(study, quantities)
    model = curves.model(study, compression(study)) if follows else process(study, study.learned)
    model.made_from_ = study.physics
    return model.fit(curves.learned(study, quantities))


def process(study: Study, outputs: Sequence[str]) -> GridGP:
    """The process of some outputs on the study's factorial, not fitted."""
    return GridGP(study.surrogate.kernel, factorial.inputs(study), outputs, compression=compression(study))


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
    decays = counts.decays(quantities, factorial.inputs(study), names)
    out = out.assign(counts.evidence(decays, {name: axis.levels or 0 for name, axis in study.factors.items()}))
    out = out.assign_coords(units=("output", [cases[name].attrs["units"] for name in names]))
    table = described(out, "errors of the surrogate on exact cases", SOURCE, MEANINGS)
    return table.assign_attrs(tolerance=study.validation.tolerance)
