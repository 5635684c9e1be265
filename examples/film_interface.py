"""Tractions between a film and its base: where it is sheared, and where it would break away behind the punch."""

import matplotlib.pyplot as plt
import numpy as np

import solver

X = np.linspace(-4.0, 4.0, 401)
film = {"composite": "fibrous", "volume_fraction": 0.5, "base": "rigid", "surroundings": "insulated"}
punch = {"radius": 0.05, "load": 1e5, "friction": 0.3}

figure, (upper, lower) = plt.subplots(2, sharex=True, figsize=(6, 6), layout="constrained")
for thickness in (0.4e-3, 0.2e-3, 0.1e-3):
    case = film | punch | {"thickness": thickness}
    contact = solver.solve(case)
    half = float(contact["contact_trailing"] + contact["contact_leading"]) / 2
    # a hair above the interface: a point on it is the film's as well, but depths are rounded
    inside = solver.solve_interior(case, X, [-(1 - 1e-9) * thickness / half], fields=["stress_xy", "stress_yy"])
    shear, normal = (inside[name].squeeze() / 1e6 for name in ("stress_xy", "stress_yy"))
    upper.plot(X, shear, label=f"{thickness * 1e3:g} mm")
    lower.plot(X, normal)
    print(
        f"{thickness * 1e3:g} mm: shear {abs(shear).max():.1f} MPa at X = {X[abs(shear).argmax('x')]:.2f}, "
        f"tension {normal.max():.2f} MPa at X = {X[normal.argmax('x')]:.2f}"
    )
upper.set(ylabel="shear $\\sigma_{xy}$ [MPa]")
upper.legend(title="thickness")
lower.set(xlabel="(x - c)/h", ylabel="$\\sigma_{yy}$ [MPa], cut at -60", ylim=(-60, 15))
lower.axhline(0, color="black", linewidth=0.5)
figure.savefig("film-interface.svg", metadata={"Date": None})
