"""A film on steel: what a base does to contact and signal, beside the half-plane of the same material."""

import matplotlib.pyplot as plt
import numpy as np

import solver

punch = {"material": "PZT-4", "radius": 0.05, "friction": 0.3, "load": 1e5}
film = solver.solve(punch | {"thickness": [0.2e-3, 0.5e-3, 1e-3], "surroundings": "insulated", "base": "steel"})
half_plane = solver.solve(punch)

table = film[["contact_trailing", "voltage_per_load", "charge_per_force"]].to_dataframe()
print(table.to_string(float_format="{:.4g}".format))
ratio = float(film["charge_per_force"].sel(thickness=0.5e-3) / half_plane["charge_per_force"])
print(f"charge per load of 0.5 mm over that of the half-plane: {ratio:.4f}")

thickness = np.geomspace(0.05e-3, 5e-3, 25)
several = solver.solve(punch | {"thickness": thickness, "surroundings": "insulated", "base": "steel"})
figure, axes = plt.subplots(figsize=(6, 3.2), layout="constrained")
axes.semilogx(1e3 * thickness, 1e12 * several["charge_per_force"].values, label="film on steel")
axes.axhline(1e12 * float(half_plane["charge_per_force"]), ls="--", label="half-plane")
axes.set(xlabel="thickness [mm]", ylabel="charge per load [pC/N]")
axes.legend()
figure.savefig("film-on-steel.svg", metadata={"Date": None})
