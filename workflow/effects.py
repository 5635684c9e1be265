"""The parametric study: one factor at a time about a baseline, on the exact solver."""

import xarray as xr

from solver import solve
from solver.names import FIELDS
from workflow.study import Study


def effect(study: Study, factor: str) -> xr.Dataset:
    """Quantities over the values of one factor and surface fields over (factor, position).

    Parameters
    ----------
    study
        A study with ``effects``.
    factor
        Which of ``effects.vary``.
    """
    if study.effects is None:
        raise ValueError("effects: the study has none")
    case = study.effects.case(factor)
    positions = study.effects.positions.values()
    out = solve(case, positions, materials=study.own_materials, phases=study.phases)
    out.attrs = {"title": f"effect of {factor}", "fields": " ".join(FIELDS)}
    return out
