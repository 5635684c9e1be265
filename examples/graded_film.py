"""A graded film: BaTiO3 fibres from 20 % at the surface to 80 % at the base, beside 50 % throughout."""

import solver

film = {"composite": "fibrous", "thickness": 0.2e-3, "base": "rigid", "radius": 0.05, "load": 1e5}
graded, even = {"volume_fraction": 0.2, "base_volume_fraction": 0.8}, {"volume_fraction": 0.5}
for label, fraction in (("20% to 80%", graded), ("50%", even)):
    answer = solver.solve(film | fraction)
    pressure, charge = float(answer["peak_pressure"]) / 1e6, float(answer["charge_per_force"]) * 1e12
    print(f"{label}: largest pressure {pressure:.1f} MPa, {charge:.2f} pC/N")
