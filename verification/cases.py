"""Cases and constants that the groups share."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

import solver
from verification.findings import off
from verification.oracles.half_plane import CONSTANTS

Array = NDArray[np.float64]
Case = dict[str, Any]
SIH_SONG = "BaTiO3-CoFe2O4 50:50"
#: A case in which every term matters: friction, both charges, a datum other than 1 m.
CHARGED: Case = {
    "radius": 0.05, "load": 1e5, "friction": 0.3, "charge": 1e-6, "magnetic_charge": -2e-3, "datum": 0.2
}  # fmt: skip


def bonded(case: Case, thickness: float) -> Case:
    """Return the case of a film [m] on a base of its own material, bonded in both fields."""
    interface = {"interface_electric": "bonded", "interface_magnetic": "bonded", "surroundings": "insulated"}
    return case | interface | {"thickness": thickness, "base": case["material"]}


def own_base_error(case: Case, thickness: float) -> float:
    """Largest difference of a quantity between a body and a `bonded` film on it, over its largest size."""
    alone, film = solver.solve(case), solver.solve(bonded(case, thickness))
    shared = [name for name in alone.data_vars if name in film and np.any(alone[name] != 0)]
    return max(off(film[name], alone[name]) for name in shared)


def half_length(solved: xr.Dataset) -> Array:
    """Half-length (a + b)/2 of a solved contact [m]."""
    return np.asarray(solved.contact_trailing + solved.contact_leading) / 2


def constants(material: solver.Material) -> dict[str, float]:
    """Plain constants of a material, SI units, with c12 and rho where it has them."""
    names = [*CONSTANTS, *(name for name in ("c12", "rho") if np.isfinite(getattr(material, name)))]
    return {name: float(getattr(material, name)) for name in names}
