"""A design in Python: the question of a study file, asked of a surrogate that is trained in memory."""

from pathlib import Path

from workflow.dataset.factorial import exact, levels
from workflow.design.search.design import Design
from workflow.learning.training import fit
from workflow.study import load

study = load(Path(__file__).parents[1] / "config/quickstart.yaml")
model = fit(study, exact(study, dict(levels(study))))  # 41,600 cases
sensor = Design.of(study, "sensor", model)  # polished and judged on the exact solver

print(sensor.verdict)
print(f"{sensor.factors['volume_fraction']:.4f} of BaTiO3, radius {sensor.factors['radius']:.4f} m")
for term, value in sensor.exact.items():
    print(f"{term}: exact {value:.5g}")
