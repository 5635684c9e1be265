"""The largest stresses of the body: searched for below the depth 0.1 h, and how friction moves them."""

import solver

cases = {"material": "PZT-4", "radius": 0.05, "friction": [0.0, 0.2, 0.4, 0.6], "load": 1e5}
answer = solver.solve(cases, peaks=True)

for friction in answer["friction"].values:
    case = answer.sel(friction=friction)
    stress, tension = (float(case[name]) / 1e6 for name in ("peak_von_mises", "peak_principal_tension"))
    depth = float(case["peak_von_mises_depth"]) * 1e3
    print(f"friction {friction:.1f}: von Mises {stress:.1f} MPa at {depth:.3f} mm, tension {tension:.1f} MPa")
