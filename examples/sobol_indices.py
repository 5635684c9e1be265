"""Which factor matters: exact Sobol' indices of a surrogate, without sampling."""

import solver
import surrogate
from surrogate.use.sensitivity import sobol

levels = {
    "volume_fraction": surrogate.chebyshev_levels(0.2, 0.8, 12),
    "friction": surrogate.chebyshev_levels(0.0, 0.6, 5),
    "radius": surrogate.chebyshev_levels(0.02, 0.2, 6, "log"),
    "load": surrogate.chebyshev_levels(5e3, 5e4, 6, "log"),
}
outputs = ["voltage_per_load", "trailing_tension"]
indices = sobol(surrogate.GridGP(outputs=outputs).fit(solver.solve(levels)))

print(indices["total"].to_pandas().T.to_string(float_format="{:.3f}".format))
