"""Trial of a read-out: factors inferred from measured quantities, and the coverage of their intervals."""

import numpy as np
import xarray as xr

from approximation.arrays import Array
from surrogate import GaussianProcess
from surrogate.intervals.distribution import NOMINAL
from surrogate.use.inversion import Inversion
from workflow.dataset import factorial
from workflow.study.categories import output
from workflow.study.model import Study
from workflow.study.sections import Readout, error


def trial(study: Study, readout: Readout, model: GaussianProcess) -> xr.Dataset:
    """Infer random true cases that solver and model answer from exact quantities with random errors of measurement."""
    random = np.random.default_rng((study.validation.seed, 2))
    inputs = [input_ for input_ in factorial.inputs(study) if input_.name in readout.infer]
    names = list(readout.measured)
    true = np.stack([input_.from_unit(random.uniform(-1, 1, readout.cases)) for input_ in inputs])
    true_points = {axis.name: xr.DataArray(row, dims="case") for axis, row in zip(inputs, true, strict=True)}
    solved = factorial.exact(study.narrowed(readout.combination), {**readout.held, **true_points})
    like = next(iter(true_points.values()))
    exact = np.stack([solved[name].broadcast_like(like).values for name in names], -1)
    measured = exact + _errors(readout, exact) * random.standard_normal(exact.shape)
    combination = {name: readout.combination[name] for name in study.categories}
    outputs = [output(name, combination) for name in names]
    forward = model.only(outputs) if study.kind.tabled else model  # of the many outputs that films have, only those
    inversion = Inversion(forward, [input_.name for input_ in inputs], outputs, readout.held)
    estimates = [
        inversion.estimate(row, errors) for row, errors in zip(measured, _errors(readout, measured), strict=True)
    ]
    mean, low, high = (
        np.stack([getattr(posterior, key) for posterior in estimates], -1) for key in ("mean", "low", "high")
    )
    dims = ("factor", "case")
    left = [(axis.to_unit(b) - axis.to_unit(a)) / (2 * NOMINAL) for axis, a, b in zip(inputs, low, high, strict=True)]
    return xr.Dataset(
        {
            "true": (dims, true),
            "mean": (dims, mean),
            "low": (dims, low),
            "high": (dims, high),
            "coverage": ("factor", ((low <= true) & (true <= high)).mean(-1)),
            "width": ("factor", np.median((high - low) / (high + low), -1)),
            "left": ("factor", np.median(left, -1)),
        },
        coords={"factor": [input_.name for input_ in inputs]},
    )


def _errors(readout: Readout, values: Array) -> Array:
    """Return the standard deviations of measured values, (n, m)."""
    parts = [error(name, text) for name, text in readout.measured.items()]
    return np.stack([absolute + share * np.abs(values[:, k]) for k, (absolute, share) in enumerate(parts)], -1)
