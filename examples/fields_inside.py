"""Fields inside the body: a map of the von Mises stress below a sliding punch, as a picture."""

import matplotlib.pyplot as plt
import numpy as np

import solver

case = {"material": "PZT-4", "radius": 0.05, "friction": 0.3, "load": 1e5}
x, y = np.linspace(-2, 2, 81), np.linspace(-2, -0.05, 40)  # in half-widths of the contact, from its middle
inside = solver.solve_interior(case, x, y, fields=["von_mises", "electric_field_y"])

stress = inside["von_mises"].squeeze() / 1e6
worst = stress.isel(stress.argmax(...))
figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
mesh = axes.pcolormesh(inside["x"], inside["y"], stress.transpose("y", "x"), rasterized=True)
axes.plot(worst["x"], worst["y"], "k+")
axes.set(xlabel="(x - c)/h", ylabel="y/h")
figure.colorbar(mesh, label="von Mises stress [MPa]")
figure.savefig("fields-inside.svg", metadata={"Date": None})
print(f"largest on the grid: {float(worst):.1f} MPa at x = {float(worst['x']):.2f} h, y = {float(worst['y']):.2f} h")
