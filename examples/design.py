"""A design in Python: the question of a study file, asked of a surrogate that is trained in memory."""

from pathlib import Path

import solver
import surrogate
from workflow.dataset.factorial import inputs
from workflow.design.search import solve_target
from workflow.study import load

study = load(Path(__file__).parents[1] / "config/quickstart.yaml")
box = inputs(study)
levels = {one.name: one.levels(count) for one, count in zip(box, (20, 5, 8, 8, 2), strict=True)}
model = surrogate.GridGP(inputs=box).fit(solver.solve(levels))
sensor = solve_target(study, "sensor", model)  # polished and judged on the exact solver

chosen = {str(name): float(value) for name, value in sensor["value"].to_series().items()}
print(f"{chosen['volume_fraction']:.4f} of BaTiO3, radius {chosen['radius']:.4f} m")
for term in sensor["term"].values:
    print(f"{term}: exact {float(sensor['exact'].sel(term=term)):.5g}")
