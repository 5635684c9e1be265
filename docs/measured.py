"""Makes ``examples/measured.csv``: made-up measurements of the film study, with another base and a meter that errs.

The exact solver answers for a steel of 184 GPa and Poisson's ratio 0.28 (study: 200 GPa, 0.3) and for a BaTiO3 with
12 % less permittivity. The meter shows 3 % less voltage than there is at the lowest load, and the truth at the highest.
Normal errors of the stated size are added, seed 0; a tenth of the voltages is missing.
"""

from pathlib import Path

import numpy as np

import solver
from storage.files import write_bytes

CSV = Path(__file__).parents[1] / "examples/measured.csv"
STEEL = solver.Material.isotropic(184e9, 0.28, name="steel")
BARIUM_TITANATE = solver.find("BaTiO3 (alternative 1)")
SPECIMENS = 12
LOADS = (1e4, 2.2e4, 4.6e4, 1e5)  # N/m
#: Standard deviations of errors, over the value.
ERRORS = {"voltage": 0.005, "capacitance_per_length": 0.01, "depth": 0.005}


def rows() -> list[dict[str, float | str]]:
    """A row a specimen and load; numbers as they are written."""
    random = np.random.default_rng(0)
    table: list[dict[str, float | str]] = []
    for _ in range(SPECIMENS):
        u = random.uniform(size=4)
        factors = {
            "volume_fraction": round(0.2 + 0.6 * u[0], 2), "friction": round(0.05 + 0.4 * u[1], 2),
            "thickness": round(1.2e-4 * 7**u[2], 6), "radius": round(0.025 * 3.6**u[3], 4),
        }  # fmt: skip
        exact = solver.solve(
            {**factors, "load": list(LOADS), "base": STEEL, "interface_electric": "grounded",
             "interface_magnetic": "grounded"},
            phases=(BARIUM_TITANATE, "CoFe2O4"),
        )  # fmt: skip
        for k, load in enumerate(LOADS):
            read = {name: float(exact[name][k]) for name in ERRORS}
            read["voltage"] *= 1 - 0.03 * (1 - np.log(load / LOADS[0]) / np.log(LOADS[-1] / LOADS[0]))
            row: dict[str, float | str] = {
                **factors, "thickness": round(factors["thickness"] * 1e6, 1), "load": load,
                "charge": 0.0, "magnetic_charge": 0.0, "surroundings": "insulated", "base": "steel",
            }  # fmt: skip
            missing = random.uniform() < 0.1
            for name, share in ERRORS.items():
                std = float(f"{abs(read[name]) * share:.2g}")
                measured = name != "voltage" or not missing
                value = read[name] + std * random.normal()
                row |= {name: f"{value:.5g}" if measured else "", f"{name}_std": f"{std:g}" if measured else ""}
            table.append(row)
    return table


def written(table: list[dict[str, float | str]]) -> bytes:
    """The table as a file, with where it comes from."""
    header = ["thickness [um]" if name == "thickness" else name for name in table[0]]
    lines = [
        "# made up: exact answers on a base of 184 GPa with errors added, by `python -m docs.measured`",
        ",".join(header),
    ]
    return "".join(f"{line}\n" for line in [*lines, *(",".join(map(str, row.values())) for row in table)]).encode()


if __name__ == "__main__":
    write_bytes(CSV, written(rows()))
