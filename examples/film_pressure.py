"""Pressure and charge under the punch as a film thins: it stiffens, and charges only under the contact."""

import matplotlib.pyplot as plt
import numpy as np

import solver

THICKNESSES = [1e-3, 2e-4, 4e-5]  # m
X = np.linspace(-1.0, 1.0, 201)[1:-1]

film = {
    "composite": "fibrous",
    "volume_fraction": 0.5,
    "surroundings": "insulated",
    "base": "rigid",
    "thickness": THICKNESSES,
}
punch = {"radius": 0.05, "load": 1e5, "friction": 0.3}
fields = solver.solve(film | punch, X)

figure, (upper, lower) = plt.subplots(2, sharex=True, figsize=(6, 6), layout="constrained")
for thickness in THICKNESSES:
    case = fields.sel(thickness=thickness)
    upper.plot(X, case["contact_pressure"] / 1e6, label=f"{thickness * 1e3:g} mm")
    lower.plot(X[5:-5], case["electric_displacement_y"][5:-5] * 1e3)  # without its ends: it is singular at the edges
upper.set(ylabel="contact pressure [MPa]")
lower.set(xlabel="(x - c)/h", ylabel="charge density $D_y$ [mC/m$^2$]")
upper.legend(title="thickness")
figure.savefig("film-pressure.svg", metadata={"Date": None})

peaks = fields["peak_pressure"].values / 1e6
print("largest pressure [MPa]:", ", ".join(f"{value:.1f}" for value in peaks))
