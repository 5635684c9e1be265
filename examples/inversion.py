"""A measurement read back: load and radius of the punch from a voltage and the end of the contact."""

import numpy as np

import solver
import surrogate
from surrogate.use.inversion import Inversion

levels = {
    "radius": surrogate.chebyshev_levels(0.02, 0.2, 10, "log"),
    "load": surrogate.chebyshev_levels(5e3, 5e4, 10, "log"),
}
body = {"composite": "fibrous", "volume_fraction": 0.6, "friction": 0.2}
model = surrogate.GridGP(outputs=["voltage", "contact_trailing"]).fit(solver.solve(levels | body))

truth = {"radius": 0.08, "load": 2e4}
measured = solver.solve(truth | body)[["voltage", "contact_trailing"]]
values = np.array([float(measured[name]) for name in measured])
estimate = Inversion(model, ["radius", "load"], list(measured), known={}).estimate(values, errors=1e-3 * abs(values))

for name, mean, low, high in zip(truth, estimate.mean, estimate.low, estimate.high, strict=True):
    print(f"{name}: {mean:.4g} [{low:.4g}, {high:.4g}], true {truth[name]:g}")
