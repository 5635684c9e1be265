"""A material of your own from a YAML file, whose constants may carry units, beside a built-in one."""

from pathlib import Path

import solver
from workflow.study.reading import read_material

label, mine = read_material(Path(__file__).with_name("material.yaml"))
cases = {"material": [mine, "PZT-4"], "radius": 0.05, "load": 1e4}
answer = solver.solve(cases)

for name in (label, "PZT-4"):
    case = answer.sel(material=name)
    charge, voltage = (float(case[what]) for what in ("charge_per_force", "voltage_per_load"))
    print(f"{name}: {charge * 1e12:.1f} pC/N, {voltage * 1e3:.2f} mV m/N")
