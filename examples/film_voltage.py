"""Voltage per load and charge per load against the thickness of a film: more volts, but a best thickness for charge."""

import matplotlib.pyplot as plt
import numpy as np

import solver

thickness = np.geomspace(2e-5, 2e-2, 61)  # m
film = {"composite": "fibrous", "volume_fraction": 0.5, "thickness": thickness, "surroundings": "insulated"}
punch = {"radius": 0.05, "load": 1e5}

figure, (upper, lower) = plt.subplots(2, sharex=True, figsize=(6, 6), layout="constrained")
for base in ("rigid", "silicon", "steel"):
    answer = solver.solve(film | punch | {"base": base})
    charge = 1e12 * answer["charge_per_force"].values
    upper.loglog(thickness * 1e3, abs(answer["voltage"]) / answer["load"], label=base)
    lower.semilogx(thickness * 1e3, charge)
    best = charge.argmax()
    print(f"{base}: most charge, {charge[best]:.2f} pC/N, at {thickness[best] * 1e3:.2f} mm")
upper.set(ylabel="voltage per load [V m/N]")
lower.set(xlabel="thickness [mm]", ylabel="charge per load [pC/N]")
upper.legend(title="base")
figure.savefig("film-voltage.svg", metadata={"Date": None})
