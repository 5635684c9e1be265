"""Exact fields on and below the surface of a recommended design, in the scenario that decides."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from solver import MaterialError, solve_interior
from solver.fields import POINT_FIELDS
from workflow.dataset import factorial
from workflow.study.model import Study
from workflow.study.sections import Positions

#: Surface fields shown, by their name in the data set of a design.
SURFACE = tuple(
    dict.fromkeys(("contact_pressure", "electric_displacement_y", "magnetic_induction_y", "stress_xx", *POINT_FIELDS))
)
_POSITIONS = Positions(inside=120, outside=120)
_X, _Y = np.linspace(-3.0, 3.0, 121), -np.linspace(0.03, 3.0, 61)


def fields(study: Study, case: Mapping[str, float]) -> xr.Dataset:
    """Return exact fields of one case of a study; none of a contact in space, which has maps in place of lines."""
    if study.kind.space:
        return xr.Dataset()
    factors = {**study.fixed, **case}
    surface = factorial.exact(study, dict(case), _POSITIONS.values(), peaks=())
    parts = {f"field_{name}": surface[name].reset_coords(drop=True) for name in SURFACE if name in surface}

    def below(names: list[str]) -> xr.Dataset:
        return study.solved(solve_interior, factors, _X, _Y, fields=names)

    try:
        inside = below(["stress_xx", "von_mises"])
    except MaterialError:  # no c12: no stress out of the plane, and under a point none in the surface
        inside = xr.Dataset() if study.kind.contact == "point" else below(["stress_xx"])
    parts |= {f"inside_{name}": array.reset_coords(drop=True) for name, array in inside.data_vars.items()}
    return xr.Dataset(parts)
