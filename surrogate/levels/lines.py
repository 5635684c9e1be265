"""Decay of Chebyshev coefficients along the complete lines among the cases of a cross approximation."""

import numpy as np
import xarray as xr

from approximation.arrays import Array, Indices
from surrogate.data.factorial import output_names
from surrogate.gp.crossgp import CrossGP
from surrogate.levels.counts import Decays, largest
from surrogate.levels.decay import decay_of


def decays(model: CrossGP, X: xr.Dataset) -> Decays:
    """Return the decay of every output along every input, from all complete lines of levels among the cases."""
    known = model.blocks(X)
    indices, blocks = np.array(list(known), dtype=np.intp), np.stack(list(known.values()))
    spread = np.ptp(blocks, axis=(0, 1))
    values = blocks / np.where(spread > 0, spread, 1.0)
    whole = values.reshape(len(values), *(model.levels[name] for name in model.whole), values.shape[-1])
    columns = {
        name: largest(_whole_lines(indices, values, k, model.levels[name]), 1) for k, name in enumerate(model.crossed)
    }
    columns |= {name: largest(whole, 1 + k) for k, name in enumerate(model.whole)}
    return {
        output: {name: decay_of(columns[name][:, p]) for name in model.levels}
        for p, output in enumerate(output_names(X, model.outputs, exclude=tuple(model.levels)))
    }


def _whole_lines(indices: Indices, values: Array, k: int, size: int) -> Array:
    """Return the values, (lines, size, b, p), along all lines that have every value of index k."""
    others = np.delete(indices, k, axis=1)
    _, line = np.unique(others, axis=0, return_inverse=True)
    order = np.lexsort((indices[:, k], line.ravel()))
    counts = np.bincount(line.ravel())
    complete = np.repeat(counts == size, counts)
    return np.asarray(values[order[complete]].reshape(-1, size, *values.shape[1:]))
