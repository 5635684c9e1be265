"""A half-plane by hand: a steel cylinder's contact, beside the formula of Hertz."""

import math

import solver

steel = solver.Material.isotropic(young=210e9, poisson=0.3, name="steel")
case = {"material": steel, "radius": 0.05, "load": 1e5}  # m, N per metre out of the plane
exact = solver.solve(case)

half_width = float(exact["contact_trailing"])
hertz = 2 * math.sqrt(case["load"] * case["radius"] * (1 - 0.3**2) / (math.pi * 210e9))
print(f"half-width {half_width * 1e6:.1f} um, {half_width / hertz:.12f} times that of Hertz")
