"""Intervals that hold: calibrated on some exact cases, and counted on others."""

import numpy as np
import xarray as xr
from scipy.stats import qmc

import solver
import surrogate

INPUTS = [surrogate.Input("volume_fraction", 0.2, 0.8), surrogate.Input("radius", 0.02, 0.2, "log")]


def scattered(count: int, seed: int) -> xr.Dataset:
    """Random exact cases, along one dimension."""
    unit = 2 * qmc.LatinHypercube(len(INPUTS), rng=seed).random(count) - 1
    columns = {axis.name: ("case", axis.from_unit(unit[:, k])) for k, axis in enumerate(INPUTS)}
    return solver.solve(dict(xr.Dataset(columns)) | {"load": 1e4, "friction": 0.2})


levels = {axis.name: axis.levels(count) for axis, count in zip(INPUTS, (12, 8), strict=True)}
exact = solver.solve(levels | {"load": 1e4, "friction": 0.2})
model = surrogate.GridGP(inputs=INPUTS, outputs=["voltage"]).fit(exact).calibrate(scattered(5000, 1))

fresh = scattered(3000, 2)
points = {axis.name: fresh[axis.name] for axis in INPUTS}
for level in (0.5, 0.8, 0.95):
    ends = model.interval(points, level=level)
    inside = (ends["voltage_lower"] <= fresh["voltage"]) & (fresh["voltage"] <= ends["voltage_upper"])
    print(f"{level:.0%} intervals hold a share of {float(np.mean(inside)):.2f} of 3,000 fresh cases")
