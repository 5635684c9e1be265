"""A graded film: BaTiO3 fibres from 20 % at the surface to 80 % at the base, beside 50 % throughout."""

import solver

film = {"composite": "fibrous", "thickness": 0.2e-3, "base": "rigid", "radius": 0.05, "load": 1e5}
for surface, base in ((0.2, 0.8), (0.5, 0.5)):
    answer = solver.solve(film | {"volume_fraction": surface, "base_volume_fraction": base})
    pressure, charge = float(answer["peak_pressure"]) / 1e6, float(answer["charge_sensitivity"]) * 1e12
    print(f"{surface:.0%} to {base:.0%}: largest pressure {pressure:.1f} MPa, {charge:.2f} pC/N")
