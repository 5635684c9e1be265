"""A surrogate trained in memory within a second, asked for a value, its interval and its slope, and kept in a file."""

import solver
import surrogate

levels = {
    "volume_fraction": surrogate.chebyshev_levels(0.2, 0.8, 16),
    "radius": surrogate.chebyshev_levels(0.02, 0.2, 8, "log"),
    "load": surrogate.chebyshev_levels(5e3, 5e4, 8, "log"),
}
exact = solver.solve(levels | {"composite": "fibrous", "friction": 0.2})
model = surrogate.GridGP(outputs=["voltage", "depth"]).fit(exact)
surrogate.save(model, "voltage.nc")

model, point = surrogate.load("voltage.nc"), {"volume_fraction": 0.6, "radius": 0.1, "load": 1e4}
value, slope = float(model.predict(point)["voltage"]), float(model.gradient(point)["voltage"].sel(input="load"))
truth = float(solver.solve(point | {"friction": 0.2})["voltage"])
print(f"voltage {value:.4f} V, exact {truth:.4f} V; {slope * 1e3:.3f} mV for another N/m")
print(model.interval(point)[["voltage_lower", "voltage_upper"]].to_pandas().to_string(float_format="{:.3f}".format))
