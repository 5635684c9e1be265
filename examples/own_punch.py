"""A punch of one's own: any polynomial slope, here y = x^4/(4 s^3), flatter in the middle than a cylinder."""

import matplotlib.pyplot as plt
import numpy as np

import solver

X = np.linspace(-0.99, 0.99, 199)
body = {"material": "PZT-4", "load": 1e5}
quartic = solver.Profile.polynomial([0, 0, 0, 1 / 2e-3**3])  # slope x^3/s^3 with s = 2 mm
punches = {"quartic": {"profile": quartic}, "cylinder": {"radius": 0.05}}

figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
for name, punch in punches.items():
    case = solver.solve(body | punch, X)
    middle = float(case["contact_trailing"] - case["contact_leading"]) / 2
    half = float(case["contact_trailing"] + case["contact_leading"]) / 2
    pressure = case["contact_pressure"] / 1e6
    axes.plot((middle + half * X) * 1e3, pressure, label=name)
    place = abs(float(pressure.idxmax("position")))
    print(f"{name}: largest pressure {float(pressure.max()):.1f} MPa at |X| = {place:.2f}")
axes.set(xlabel="x [mm]", ylabel="contact pressure [MPa]")
axes.legend()
figure.savefig("own-punch.svg", metadata={"Date": None})
