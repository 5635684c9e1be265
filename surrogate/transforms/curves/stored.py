"""Curves and what follows from them as plain arrays: the part of a file that a `CurveGP` has beside its process."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from approximation.measure import Measure
from approximation.panels import Panels
from surrogate.transforms.curves.basis import Basis, Curves, Largest

# Most points of the panels of one file's curves.
_MOST = 1000

Arrays = dict[str, tuple[tuple[str, ...], NDArray[np.generic]]]


def to_arrays(curves: Sequence[Curves], bases: Sequence[Basis], largest: Mapping[str, Largest]) -> Arrays:
    """Return the arrays by name with their dimensions: what `from_arrays` reads."""
    measures = list(dict.fromkeys(summit.measure for summit in largest.values()))
    state: Arrays = {
        "largest_output": (("largest",), np.array(list(largest))),
        "largest_curves": (("largest",), np.array([summit.curves for summit in largest.values()])),
        "largest_measure": (("largest",), np.array([measures.index(summit.measure) for summit in largest.values()])),
        "largest_place": (("largest",), np.array([summit.place for summit in largest.values()])),
    }
    for k, measure in enumerate(measures):
        dims = f"branch_{k}", f"measured_{k}"
        state[f"measure_linear_{k}"] = dims, measure.linear
        state[f"measure_root_{k}"] = (dims[0], f"row_{k}", dims[1]), measure.root
    for k, (curve, basis) in enumerate(zip(curves, bases, strict=True)):
        state[f"curve_field_{k}"] = (f"field_{k}",), np.array(curve.fields)
        state[f"curve_size_{k}"] = (f"field_{k}",), np.array(curve.sizes)
        state[f"curve_across_{k}"] = (f"panel_across_{k}",), np.array(curve.panels.across)
        state[f"curve_down_{k}"] = (f"panel_down_{k}",), np.array(curve.panels.down)
        state[f"curve_dim_{k}"] = (), np.array(curve.dim)
        state |= basis.state(k)
    return state


def from_arrays(stored: xr.Dataset, outputs: Sequence[str]) -> tuple[list[Curves], list[Basis], dict[str, Largest]]:
    """Return curves, their bases and what follows from them."""
    curves: list[Curves] = []
    bases: list[Basis] = []
    while f"curve_field_{len(curves)}" in stored:
        k = len(curves)
        across, down = (tuple(stored[f"curve_{way}_{k}"].values.tolist()) for way in ("across", "down"))
        if not all(isinstance(count, int) and 0 < count <= _MOST for count in (*across, *down)):
            raise ValueError(f"curves {k} have panels of {across} by {down} points")
        fields, sizes = (tuple(map(str, stored[f"curve_{part}_{k}"].values.tolist())) for part in ("field", "size"))
        curves.append(Curves(fields, sizes, Panels(across, down), str(stored[f"curve_dim_{k}"].item())))
        bases.append(Basis.restore(stored, k, curves[k].panels))
        if len(bases[k].mean) != len(fields):
            raise ValueError(f"the basis of curves {k} does not have their fields")
    measures: list[Measure] = []
    while f"measure_linear_{len(measures)}" in stored:
        k = len(measures)
        measures.append(Measure(stored[f"measure_linear_{k}"].values, stored[f"measure_root_{k}"].values))
    columns = [stored[f"largest_{part}"].values.tolist() for part in ("output", "curves", "measure", "place")]
    largest: dict[str, Largest] = {}
    for name, curve, measure, place in zip(*columns, strict=True):
        if name not in outputs or not (0 <= curve < len(curves) and 0 <= measure < len(measures)):
            raise ValueError(f"what follows as {name!r} is not there")
        if measures[measure].fields > len(curves[curve].fields) or not -1 <= place < len(curves[curve].fields):
            raise ValueError(f"{name!r} follows from fields that its curves do not have")
        largest[str(name)] = Largest(curve, measures[measure], place)
    return curves, bases, largest
