"""A material by its volume fraction: the composite of BaTiO3 and CoFe2O4 with the most voltage per load."""

import matplotlib.pyplot as plt
import numpy as np

import solver

figure, axes = plt.subplots(figsize=(6, 3.2), layout="constrained")
fractions = np.linspace(0.05, 0.95, 91)
for composite in ("fibrous", "laminate"):
    answer = solver.solve({"composite": composite, "volume_fraction": fractions, "radius": 0.05, "load": 1e4})
    voltage = abs(answer["voltage_per_load"])
    best, most = float(voltage.idxmax("volume_fraction")), 1e3 * float(voltage.max())
    print(f"{composite}: most volts per load, {most:.2f} mV m/N, with {100 * best:.0f} % of BaTiO3")
    axes.plot(100 * fractions, 1e3 * voltage.values, label=composite)
axes.set(xlabel="BaTiO3 [%]", ylabel="voltage per load [mV m/N]", ylim=(0, None))
axes.legend()
figure.savefig("volume-fraction.svg", metadata={"Date": None})
