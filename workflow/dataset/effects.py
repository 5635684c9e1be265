"""The parametric study: one factor at a time about a baseline, on the exact solver, along the surface and inside."""

import xarray as xr

from solver import solve, solve_interior
from solver.names import FIELDS
from workflow.study.model import Study


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
    return out.assign_attrs(title=f"effect of {factor}", fields=" ".join(FIELDS))


def interior(study: Study, factor: str) -> xr.Dataset:
    """Fields below the punch over (factor, y, x), at three of the factor's values: first, middle and last.

    Parameters
    ----------
    study
        A study with ``effects.interior``.
    factor
        Which of ``effects.vary``.
    """
    if study.effects is None or study.effects.interior is None:
        raise ValueError("effects: the study has no interior")
    shown = study.effects.interior
    case = study.effects.case(factor)
    values = study.effects.vary[factor]
    case[factor] = [values[k] for k in dict.fromkeys((0, len(values) // 2, len(values) - 1))]
    x, y = shown.grid()
    out = solve_interior(case, x, y, fields=shown.fields, materials=study.own_materials, phases=study.phases)
    return out.assign_attrs(title=f"effect of {factor} inside the body", fields=" ".join(shown.fields))
