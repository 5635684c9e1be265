"""Films of many factors: cross approximation and a sparse grid side by side, from as many tables of the solver.

``python -m benchmarks.manyfactors [TOLERANCE [STUDY.yaml]]`` takes `config/two_layers.yaml`: a place in its five
crossed factors is a table, at which all levels of the others are solved. Errors are those at fresh places in the box.
"""

import sys
from pathlib import Path

import numpy as np
import xarray as xr

from approximation.arrays import Array
from benchmarks.history import printed
from benchmarks.sparse import sparse_grid
from benchmarks.timing import timed
from surrogate import GaussianProcess
from surrogate.data.inputs import Input
from workflow.dataset import batches, factorial
from workflow.learning import training
from workflow.run.provenance import ROOT
from workflow.study.model import Study, load

_FRESH = 40


def measure(tolerance: float = 1e-3, path: str | Path = ROOT / "config" / "two_layers.yaml") -> dict[str, float]:
    """Places, seconds of processor time, and errors over range: largest of all quantities, their median, voltage."""
    study = load(path)
    study = study.model_copy(
        update={"validation": study.validation.model_copy(update={"tolerance": tolerance, "cases": _FRESH})}
    )
    box = {input_.name: input_ for input_ in factorial.inputs(study)}
    random = np.random.default_rng(1)
    fresh = random.uniform(-1, 1, (_FRESH, len(study.crossed)))
    truth, exact = timed(lambda: _blocks(study, _solved(study, box, fresh)))
    low, spread = truth.min(axis=(0, 1)), np.ptp(truth, axis=(0, 1))

    def learned() -> tuple[xr.Dataset, GaussianProcess]:
        parts: list[xr.Dataset] = []
        while "place" in (places := training.places(study, parts)).sizes:
            parts.append(_solved(study, box, _scaled(study, box, places)))
        data = batches.joined(parts)
        return data, training.fit(study, data)

    (data, model), ours = timed(learned)
    asked = {name: xr.DataArray(box[name].from_unit(fresh[:, k]), dims="place") for k, name in enumerate(study.crossed)}
    whole = {name: some for name, some in factorial.levels(study).items() if name not in study.crossed}
    predicted = _blocks(study, model.predict({**asked, **whole}, return_std=False))
    count = data.sizes["place"]

    def scaled_blocks(t: Array) -> Array:
        return np.asarray((_blocks(study, _solved(study, box, t)) - low) / spread)

    grid, rival = timed(lambda: sparse_grid(scaled_blocks, fresh.shape[1], count))
    measured = {
        "tolerance": tolerance,
        "places": float(count),
        "cases": float(count * study.block),
        "seconds_a_place": exact.processor / _FRESH,
    }
    for name, cost, got in (("cross", ours, predicted), ("sparse_grid", rival, grid(fresh) * spread + low)):
        error = (np.abs(got - truth) / spread).max(axis=(0, 1))
        measured |= {
            f"{name}_seconds": cost.processor,
            f"{name}_largest_error": float(error.max()),
            f"{name}_median_error": float(np.median(error)),
            f"{name}_voltage_error": float(error[study.outputs.index("voltage")]),
        }
    return measured


def _scaled(study: Study, box: dict[str, Input], places: xr.Dataset) -> Array:
    """Places in the scaled coordinates of the crossed factors, (n, d)."""
    return np.stack([box[name].to_unit(places[name].values) for name in study.crossed], axis=1)


def _solved(study: Study, box: dict[str, Input], t: Array) -> xr.Dataset:
    """Exact cases at places and all levels of the other factors."""
    places = {name: xr.DataArray(box[name].from_unit(t[:, k]), dims="place") for k, name in enumerate(study.crossed)}
    return batches.exact(study, xr.Dataset(places))


def _blocks(study: Study, cases: xr.Dataset) -> Array:
    """Cases as blocks, (n, b, p)."""
    whole = [name for name in study.factors if name not in study.crossed]
    arrays = xr.broadcast(*(cases[name] for name in study.outputs))
    return np.stack(
        [array.transpose("place", *whole).values.reshape(array.sizes["place"], -1) for array in arrays], axis=-1
    )


if __name__ == "__main__":
    tolerance, *files = sys.argv[1:] or ["1e-3"]
    print(printed(measure(float(tolerance), *files[:1])))
