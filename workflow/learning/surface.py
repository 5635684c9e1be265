"""Surface fields under the punch as a surrogate: their regular parts over the factors and an angle.

Under the punch X = -cos(angle). Regular parts are smooth in the angle: square-root singular fields times
sqrt(1 - X^2), and the pressure over (1 - X)^alpha (1 + X)^(1 - alpha), alpha the pressure exponent.
"""

from typing import Any

import numpy as np
import xarray as xr

from approximation.arrays import Array
from solver import solve
from solver.fields import FIELDS
from storage.described import described
from surrogate import GaussianProcess, GridGP, GroupedGP, Input
from surrogate.data.meanings import MEANINGS, SOURCE
from surrogate.use import validation
from workflow.dataset import factorial, similar
from workflow.learning import training
from workflow.study import representatives
from workflow.study.model import Study

#: Fields that are learned, by their regular parts.
NAMES = ("contact_pressure", "electric_displacement_y", "magnetic_induction_y", "stress_xx")
ANGLE = Input("angle", 0.0, np.pi, "linear", "rad", "angle of the position under the punch, X = -cos(angle)")
_CASES_AT_ONCE = 100  # random cases that are solved at once
_CALIBRATION = 3000  # most cases for calibration: each takes as many positions as its block has cases


def weights(X: Array, exponent: xr.DataArray) -> dict[str, xr.DataArray]:
    """Return the singular factors of regular parts at X, (position,), |X| < 1, and over the exponent's dimensions."""
    if (np.abs(X) >= 1).any():
        raise ValueError(f"positions: {X[np.abs(X) >= 1][0]:g} is not under the punch, |X| < 1")
    positions = xr.DataArray(X, dims="position", coords={"position": X})
    root = (1 - positions**2) ** -0.5
    pressure = (1 - positions) ** exponent * (1 + positions) ** (1 - exponent)
    return {name: pressure if name == "contact_pressure" else root for name in NAMES}


def fit(study: Study) -> GaussianProcess:
    """Fit and calibrate a Gaussian process of the regular parts, on the factorial and Chebyshev angles."""
    angles, levels = ANGLE.levels(study.surrogate.fields), factorial.levels(study)
    inputs, allowed = [*factorial.inputs(study), ANGLE], training.compression(study)
    model: GaussianProcess
    if study.groups:
        over = representatives.factors(study, levels)
        data = _regular(study, dict(over), angles).assign_coords({**levels, **over})
        grouping = similar.grouping(
            study, inputs, [*factorial.axis_inputs(study), ANGLE], {name: name for name in NAMES}
        )
        model = GroupedGP(grouping, compression=allowed).fit(data)
    else:
        data = _regular(study, dict(levels), angles)
        model = GridGP(inputs, NAMES, compression=allowed).fit(data)
    return model.calibrate(cases(study, min(study.validation.calibration, _CALIBRATION), 4))


def cases(study: Study, count: int, number: int) -> xr.Dataset:
    """Return random exact regular parts: factors, ``angle`` and the fields over dimension ``case``."""
    random = np.random.default_rng([study.validation.seed, number])
    inputs = [*factorial.inputs(study), ANGLE]
    columns = {input_.name: input_.from_unit(random.uniform(-1, 1, count)) for input_ in inputs}
    points = {name: xr.DataArray(column, dims="case") for name, column in columns.items()}
    parts = []
    # the solver takes the same positions for all cases: of each block only the diagonal is used
    for block in np.array_split(np.arange(count), -(-count // _CASES_AT_ONCE)):
        axes = {input_.name: points[input_.name][block] for input_ in inputs[:-1]}
        square = _regular(study, axes, columns["angle"][block])
        parts.append(square.isel(angle=xr.DataArray(np.arange(len(block)), dims="case")).drop_vars("angle"))
    return xr.concat(parts, "case").assign(points)


def validate(study: Study, model: GaussianProcess) -> xr.Dataset:
    """Return errors and coverage of the regular parts on exact cases of neither training nor calibration."""
    fresh = cases(study, study.validation.cases, 5)
    table = validation.validate(model, fresh, None)
    units = xr.DataArray([FIELDS[name].units for name in NAMES], dims="output")
    table = described(
        table.assign_coords(units=units),
        "errors of the surrogate of the surface fields on exact cases",
        SOURCE,
        MEANINGS,
    )
    return table.assign_attrs(tolerance=study.validation.tolerance)


def predict(fields: GaussianProcess, quantities: GaussianProcess, points: dict[str, Any], X: Array) -> xr.Dataset:
    """Surface fields and their intervals at positions under the punch.

    Parameters
    ----------
    fields, quantities
        The surrogates of the regular parts (``surface.nc``) and of the quantities, with ``pressure_exponent``.
    points
        Factors as for ``surrogate.GaussianProcess.predict``.
    X
        Positions (x - c)/h, |X| < 1.

    Returns
    -------
    xarray.Dataset
        ``<field>``, ``<field>_std`` and the ends of the 95 % interval, ``<field>_lower`` and ``<field>_upper``, over
        the points' dimensions and ``position``. The exponent is taken as known,
        being itself far more accurate.

    Raises
    ------
    ValueError
        A position that is not under the punch; a point outside the box.
    """
    position = np.asarray(X, dtype=np.float64)
    weight = weights(position, quantities.predict(points, return_std=False)["pressure_exponent"])
    angle = xr.DataArray(np.arccos(-position), dims="position", coords={"position": position})
    inputs = {**points, "angle": angle}
    predicted = fields.predict(inputs).assign(fields.interval(inputs).data_vars)
    return xr.Dataset(
        {
            f"{name}{suffix}": (predicted[f"{name}{suffix}"] * weight[name]).assign_attrs(FIELDS[name].attrs)
            for name in NAMES
            for suffix in ("", "_std", "_lower", "_upper")
        }
    )


def _regular(study: Study, axes: dict[str, Any], angles: Array) -> xr.Dataset:
    """Return exact regular parts over the axes' dimensions and ``angle``."""
    X = -np.cos(angles)
    out = solve({**study.fixed, **axes}, X, materials=study.own_materials, phases=study.phases, regular=True)
    parts = {name: out[f"{name}_regular"] for name in NAMES[1:]}
    singular = weights(X, out["pressure_exponent"])["contact_pressure"]
    parts["contact_pressure"] = (out["contact_pressure"] / singular).assign_attrs(FIELDS["contact_pressure"].attrs)
    return xr.Dataset(parts).rename(position="angle").assign_coords(angle=angles)
