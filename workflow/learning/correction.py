"""Measured rows on a study's surrogate: its uncertain constants and discrepancies, and the corrected surrogate."""

from collections.abc import Callable, Sequence

import numpy as np

from approximation.arrays import Array
from solver import MaterialError
from surrogate import GaussianProcess
from surrogate.data.measurements import MOST_ROWS, Measurements
from surrogate.intervals.distribution import NOMINAL, Normal
from surrogate.transforms.measured.corrected import CorrectedGP
from surrogate.use import learning
from workflow.learning.constant_effects import ConstantEffects
from workflow.learning.instruments import Instrument, shown
from workflow.learning.summary import Summary
from workflow.study import uncertainty
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.uncertainty import Constant

_WRONG_UNIT = 30.0  # measured over predicted values, as a factor, by which no constant changes a quantity
_TURNED = 0.9  # share of readings with the opposite sign from which the sign is the instrument's
_VAGUE = 1e9  # an error of measurement over the largest value: beyond it a row says nothing, and squares overflow


def learn(
    study: Study,
    model: GaussianProcess,
    rows: Measurements,
    constants: list[Constant],
    say: Callable[[str], None] = lambda message: None,
    instruments: Sequence[Instrument] = (),
) -> tuple[CorrectedGP, Summary]:
    """Correct a study's surrogate by measured rows."""
    count = len(np.unique(rows.row))
    if not 1 <= count <= MOST_ROWS:
        raise InputError(f"{count} rows with a measured value; must be 1 to {MOST_ROWS}")
    nominal = model.predict_array(rows.points)
    lower, upper = model.interval_array(rows.points, NOMINAL)
    mean = nominal[rows.row, rows.output]
    _check_size(model, rows, mean)
    for device in instruments:
        if not device.measures(model, rows).any():
            raise InputError(f"--instrument: {device.name}: no row holds a measured {device.quantity}")
    singles = uncertainty.own(study, constants)
    all_constants, count = [*constants, *singles], len(constants) + len(singles)
    effects = ConstantEffects(study, model, all_constants, say, [instrument.name for instrument in instruments])
    own_error = np.maximum(upper - nominal, nominal - lower)[rows.row, rows.output] / Normal().ends(NOMINAL)[1, 0]
    spread = np.hypot(own_error, effects.error[rows.output])
    latest: list[GaussianProcess] = []
    unknown: list[Constant | Instrument] = [*all_constants, *instruments]
    single = np.array([constant in singles for constant in unknown], np.bool_)

    def forward(z: Array) -> tuple[Array, Array]:
        moves = ", ".join(f"{value:+.2f}" for value in z[: len(constants)])
        say(f"constants at {moves} prior standard deviations")
        latest[:] = [effects.at(z)]
        predicted = latest[0].predict_array(rows.points).reshape(len(rows.points), len(model.outputs_), -1)
        own_error = predicted[rows.row, rows.output]
        return shown(list(instruments), model, rows, z[count:], mean + own_error[:, 0], own_error[:, 1 : count + 1])

    try:
        posterior = learning.learn(forward, rows, model.inputs_, len(unknown), spread, single)
    except (learning.NotSettledError, MaterialError) as error:
        raise InputError(str(error)) from None
    summary = Summary.of(posterior, rows, unknown, single, model, mean)
    names = {constant.name: constant.prior for constant in unknown}
    surrogate = CorrectedGP(
        model, latest[0], names, posterior.about, posterior.draws, rows, effects.error, "\n".join(summary.lines)
    )
    return surrogate, summary


def _check_size(model: GaussianProcess, rows: Measurements, mean: Array) -> None:
    """Refuse measured values whose sign or size shows another convention or unit than the surrogate's."""
    for q in rows.outputs:
        k = rows.of(q)
        measured, predicted = rows.value[k], mean[k]
        _check_errors(model, q, rows.error[k], float(np.abs([measured, predicted]).max()))
        ratio = float(np.median(np.abs(measured)) / max(float(np.median(np.abs(predicted))), 1e-300))
        noise = np.nanmedian(rows.error[k]) if np.isfinite(rows.error[k]).any() else 0.0
        if float(np.median(np.abs(predicted))) < 3 * noise * min(1.0, 1 / ratio if ratio else 1.0):
            continue  # nothing but noise was to be measured
        large = np.abs(measured) > 3 * noise
        opposite = bool(large.any()) and float(np.mean(measured[large] * predicted[large] < 0)) > _TURNED
        name, units = model.outputs_[q], model.attrs_[model.outputs_[q]].get("units", "")
        if not 1 / _WRONG_UNIT < ratio < _WRONG_UNIT:
            power = 3 * round(float(np.log10(max(ratio, 1e-300))) / 3)
            factor = 10.0**-power
            fits = power and 1 / _WRONG_UNIT < ratio * factor < _WRONG_UNIT
            sign = " the opposite sign and" if opposite else ""
            hint = f"; they would fit with{sign} a factor of {factor:g}" if fits else ""
            raise InputError(
                f"{name}: measured values are {ratio:.2g} times those of the surrogate; are they in {units}?{hint}"
            )
        if opposite:
            raise InputError(
                f"{name}: {int(large.sum())} measured values have the opposite sign of the surrogate's; they would fit "
                "with the opposite sign: turn it if the instrument counts the other way"
            )


def _check_errors(model: GaussianProcess, output: int, errors: Array, largest: float) -> None:
    """Refuse errors of measurement that are far larger than the values."""
    vague = errors[errors > _VAGUE * largest]
    if len(vague):
        name, units = model.outputs_[output], model.attrs_[model.outputs_[output]].get("units", "")
        raise InputError(f"{name}: an error of {vague[0]:g} {units}; must be at most {_VAGUE * largest:.2g} {units}")
