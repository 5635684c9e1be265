"""A half-plane by hand: a steel cylinder's contact, beside the formula of Hertz."""

import math

import matplotlib.pyplot as plt
import numpy as np

import solver

steel = solver.Material.isotropic(young=210e9, poisson=0.3, name="steel")
case = {"material": steel, "radius": 0.05, "load": 1e5}  # m, N per metre out of the plane
X = np.linspace(-0.99, 0.99, 199)  # in half-widths
exact = solver.solve(case, X)

half_width = float(exact["contact_trailing"])
hertz = 2 * math.sqrt(case["load"] * case["radius"] * (1 - 0.3**2) / (math.pi * 210e9))
print(f"half-width {half_width * 1e6:.1f} um, {half_width / hertz:.12f} times that of Hertz")

figure, axes = plt.subplots(figsize=(6, 3.2), layout="constrained")
pressure = exact["contact_pressure"].values / 1e6
axes.plot(X * half_width * 1e6, pressure, label="solved")
axes.plot(X[::9] * half_width * 1e6, pressure.max() * np.sqrt(1 - X[::9] ** 2), "o", mfc="none", label="Hertz")
axes.set(xlabel="x [um]", ylabel="pressure [MPa]")
axes.legend()
figure.savefig("half-plane.svg", metadata={"Date": None})
