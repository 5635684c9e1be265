"""Read-out: from measured potentials back to load and friction, and how often the intervals hold."""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from solver.names import FACTORS
from surrogate import GaussianProcess
from surrogate.inversion import Inversion
from workflow import factorial
from workflow.categories import output
from workflow.engineering import prefixed, raised
from workflow.figures import BLUE, GREY, styled
from workflow.measuring import Readout, error
from workflow.study import Study

Array = NDArray[np.float64]

_SHOWN = 150  # cases in the figure


def trial(study: Study, readout: Readout, model: GaussianProcess) -> xr.Dataset:
    """Infer random true cases from exact quantities with random errors of measurement.

    Returns
    -------
    xarray.Dataset
        ``true``, ``mean``, ``low``, ``high`` over (``factor``, ``case``), in SI units; ``coverage`` and ``width``
        (median of the half interval over its middle) over ``factor``.
    """
    random = np.random.default_rng((study.validation.seed, 2))
    inputs = [one for one in factorial.inputs(study) if one.name in readout.infer]
    names = list(readout.measured)
    true = np.stack([one.from_unit(random.uniform(-1, 1, readout.cases)) for one in inputs])
    given = {one.name: xr.DataArray(row, dims="case") for one, row in zip(inputs, true, strict=True)}
    solved = factorial.exact(study.narrowed(readout.kinds), {**readout.held, **given})
    like = next(iter(given.values()))
    exact = np.stack([solved[name].broadcast_like(like).values for name in names], -1)
    measured = exact + _errors(readout, exact) * random.standard_normal(exact.shape)
    kinds = {name: readout.kinds[name] for name in study.categories}
    inversion = Inversion(model, [one.name for one in inputs], [output(one, kinds) for one in names], readout.held)
    found = [inversion.estimate(row, one) for row, one in zip(measured, _errors(readout, measured), strict=True)]
    mean, low, high = (np.stack([getattr(one, key) for one in found], -1) for key in ("mean", "low", "high"))
    dims = ("factor", "case")
    return xr.Dataset(
        {
            "true": (dims, true),
            "mean": (dims, mean),
            "low": (dims, low),
            "high": (dims, high),
            "coverage": ("factor", ((low <= true) & (true <= high)).mean(-1)),
            "width": ("factor", np.median((high - low) / (high + low), -1)),
        },
        coords={"factor": [one.name for one in inputs]},
    )


@styled
def figure(tried: xr.Dataset) -> Figure:
    """Intervals over the truth for some of the cases, a panel for each inferred factor."""
    names = [str(name) for name in tried["factor"].values]
    drawn, axes = plt.subplots(1, len(names), figsize=(4.8 * len(names), 3.8), squeeze=False)
    for ax, name in zip(axes.flat, names, strict=True):
        one = tried.sel(factor=name).isel(case=slice(0, _SHOWN))
        spread = one["true"].values
        logarithmic = bool(spread.min() > 0 and spread.max() / spread.min() > 20)
        units = FACTORS[name].units
        size, units = (1.0, raised(units)) if logarithmic else prefixed(float(np.abs(spread).max()), units)
        true, low, high, mean = (one[key].values / size for key in ("true", "low", "high", "mean"))
        ends = [float(true.min()), float(true.max())]
        ax.plot(ends, ends, color=GREY, lw=0.8)
        ax.vlines(true, low, high, color=BLUE, lw=0.9, alpha=0.7)
        ax.plot(true, mean, ".", ms=4, color=BLUE, label="posterior mean")
        if logarithmic:
            ax.set_xscale("log")
            ax.set_yscale("log")
        ax.set_xlabel(f"true {name}" + (f" [{units}]" if units else ""))
        ax.set_ylabel(f"inferred {name}" + (f" [{units}]" if units else ""))
        ax.set_title(f"{100 * float(tried['coverage'].sel(factor=name)):.1f} % of {tried.sizes['case']} within")
    return drawn


def _errors(readout: Readout, values: Array) -> Array:
    """Standard deviations of measurements with some values, (n, m)."""
    parts = [error(name, text) for name, text in readout.measured.items()]
    return np.stack([absolute + share * np.abs(values[:, k]) for k, (absolute, share) in enumerate(parts)], -1)
