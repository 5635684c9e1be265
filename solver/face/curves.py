"""The labelled face of the curves that peaks follow from: named factors in, stresses on panels out."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
import xarray as xr

from solver.curves import REGIONS, SIZES, described
from solver.face.bodies import body_of
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.refusal import FactorError
from solver.face.rows import Factors
from solver.material.constants import Material

_OF = "factors (contact as wide as the datum, or overflow)"


def solve_curves(
    factors: Factors,
    regions: Sequence[str] = tuple(REGIONS),
    *,
    materials: Mapping[str, Material] = MappingProxyType({}),
    phases: Sequence[str | Material] = ("BaTiO3", "CoFe2O4"),
) -> xr.Dataset:
    """Exact stresses on the panels of regions, of which the peaks of every case are the largest measures.

    Parameters
    ----------
    factors, materials, phases
        As for :func:`solver.solve`.
    regions
        Names in ``solver.curves.REGIONS``.

    Returns
    -------
    xarray.Dataset
        ``solver.curves.SIZES`` that every case has over the factors' dimensions, and ``<region>_<field>`` over these
        and ``<region>_point`` for the regions that every case has: a half-plane its ``body``, a film its ``interface``,
        a homogeneous one ``film``, one on an elastic base ``base``. SI units.

    Raises
    ------
    FactorError, MaterialError
        As :func:`solver.solve` with peaks; an unknown region.

    Examples
    --------
    >>> import solver
    >>> from solver.curves import VON_MISES
    >>> case = {"material": "BaTiO3", "radius": 0.05, "load": 1e5}
    >>> curves = solve_curves(case, ["body"])
    >>> stresses = [curves[f"body_stress_{name}"].values for name in ("xx", "yy", "xy", "zz")]
    >>> largest = VON_MISES.of(np.stack(stresses, -1)).max()
    >>> bool(abs(largest / solver.solve(case, peaks=True)["peak_von_mises"] - 1) < 0.01)
    True
    """
    cases = Cases(checked(factors), materials, phases)
    for name in regions:
        if name not in REGIONS:
            raise FactorError(f"regions: {name!r} is not one of {', '.join(REGIONS)}")

    def part(cases: Cases) -> xr.Dataset:
        body, coordinates = body_of(cases), cases.coordinates
        values = body.curves(regions)
        outputs = cases.labelled({name: values[name] for name in SIZES if name in values}, SIZES, _OF)
        for name in regions:
            table = described(name)
            if not values.keys() >= table.keys():
                continue
            attrs = {"units": "1", "long_name": f"number of a point of the panels over the {name}"}
            axis = {f"{name}_point": xr.Variable(f"{name}_point", np.arange(REGIONS[name].panels.size), attrs)}
            outputs |= cases.labelled({key: values[key] for key in table}, table, _OF, axis)
            coordinates |= axis
        return xr.Dataset(outputs, coordinates)

    return cases.solved("exact stresses inside a magneto-electro-elastic body below a punch", part)
