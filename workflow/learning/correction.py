"""Measured rows correct a study's surrogate, through the effects of uncertain constants and discrepancies."""

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr

from approximation.arrays import Array
from solver import MaterialError, find
from surrogate import GaussianProcess, GridGP
from surrogate.data.measurements import MOST_ROWS, Measurements
from surrogate.intervals.distribution import NOMINAL, Normal
from surrogate.levels.counts import UnreachableError
from surrogate.levels.pilot import explore
from surrogate.transforms.measured.corrected import CorrectedGP
from surrogate.use import learning
from workflow.dataset import draws, factorial
from workflow.learning.instruments import Instrument, shown
from workflow.learning.summary import Summary
from workflow.study import categories, uncertainty
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.uncertainty import Constant, concerned, members, moved

_WRONG_UNIT = 30.0  # measured over predicted values, as a factor, by which no constant changes a quantity
_TURNED = 0.9  # share of readings with the opposite sign from which the sign is the instrument's
_VAGUE = 1e9  # an error of measurement over the largest value: beyond it a row says nothing, and squares overflow
_STEP = 0.25  # prior standard deviations, of the difference that a derivative is taken from
_STALE = {True: 1.0, False: 0.1}  # how far constants may move until derivatives are taken anew; films: True
_TOLERANCE = {True: 0.1, False: 0.02}  # over the range of every quantity, for the levels
_BUDGET, _MOST_LEVELS = 20_000, 6
_MOST_TABLES = 2000  # of films, 0.1 to 0.5 s each
_CHECKED, _TOGETHER = 200, 25  # random cases that tell the error; of films, those that share a table


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


class ConstantEffects:
    """Changes of all outputs of a surrogate when constants move, as surrogates over the same box."""

    def __init__(
        self,
        study: Study,
        model: GaussianProcess,
        constants: list[Constant],
        say: Callable[[str], None],
        silent: Sequence[str] = (),
    ) -> None:
        self._study, self._model, self._constants, self._say, self._silent = study, model, constants, say, silent
        self._levels = _levels(study, model)
        tables = int(np.prod([len(self._levels[name]) for name in study.tabled])) * len(study.combinations)
        solved = sum(not self._parts(constant) for constant in constants)
        if study.tabled and tables * solved > _MOST_TABLES:
            raise InputError(
                f"{study.path}: effects of {solved} constants need {tables} tables of films each, more than "
                f"{_MOST_TABLES} in all; name fewer constants with --uncertain"
            )
        say(f"effects of {solved} constants: exact on {self.cases} cases each")
        self._start = self._exact(np.zeros(len(constants)))
        self._at, self._slopes = np.zeros(len(constants)), self._differences(np.zeros(len(constants)), self._start)
        self.error = self._judged()

    @property
    def cases(self) -> int:
        """Cases that are solved for every constant."""
        return int(np.prod([len(level) for level in self._levels.values()])) * len(self._study.combinations)

    def at(self, z: Array) -> GridGP:
        """The change of every output at scaled constants, then its derivative by each unknown, for every output."""
        z = z[: len(self._constants)]
        exact = self._exact(z) if np.any(z) else self._start
        if np.abs(z - self._at).max() > _STALE[bool(self._study.tabled)]:
            self._say("the constants have moved: their effects anew")
            self._at, self._slopes = z.copy(), self._differences(z, exact)
        parts = {}
        for name in self._model.outputs_:
            parts[f"{name}: change"] = exact[name] - self._start[name]
            for constant, slope in zip(self._constants, self._slopes, strict=True):
                parts[f"{name}: {constant.name}"] = slope[name]
            parts |= {f"{name}: {silent}": xr.zeros_like(exact[name]) for silent in self._silent}
        return self._fitted(parts)

    def _fitted(self, parts: dict[str, xr.DataArray]) -> GridGP:
        return GridGP(self._model.inputs_, list(parts), compression=1e-5).fit(xr.Dataset(parts))

    def _exact(self, z: Array) -> xr.Dataset:
        study = moved(self._study, self._constants, z)
        return factorial.training_data(self._study, factorial.exact(study, dict(self._levels)))

    def _differences(self, z: Array, exact: xr.Dataset) -> list[xr.Dataset]:
        """Derivatives of all outputs by every scaled constant, zero where it has no part."""
        differences: dict[str, xr.Dataset] = {}
        solved = [constant for constant in self._constants if not self._parts(constant)]
        for number, constant in enumerate(solved, 1):
            self._say(f"{number} of {len(solved)}: {constant.name}")
            k = self._constants.index(constant)
            step = z + _STEP * np.eye(len(z))[k]
            held = concerned(self._study, constant)
            cases = factorial.exact(moved(self._study, self._constants, step).narrowed(held), dict(self._levels))
            categories_ = {
                name: [held[name]] if name in held else names for name, names in self._study.categories.items()
            }
            shifted = categories.apart(_expanded(cases, held), categories_, self._study.outputs)
            differences[constant.name] = xr.Dataset({
                name: (shifted[name] - exact[name]) / _STEP if name in shifted else xr.zeros_like(exact[name])
                for name in self._model.outputs_
            })  # fmt: skip
        for family in self._constants:
            for part in self._parts(family):
                share = differences[part.name] * (family.std / part.std)
                differences[family.name] = differences[family.name] + share if family.name in differences else share
        return [differences[constant.name] for constant in self._constants]

    def _parts(self, constant: Constant) -> list[Constant]:
        """The members of a family, where all of them are uncertain too, each for itself."""
        names = members(find(constant.material, self._study.own_materials), constant.family)
        parts = [other for other in self._constants if other.material == constant.material and other.family in names]
        return parts if len(parts) == len(names) else []

    def _judged(self) -> Array:
        """Standard deviation of what the effects leave at random cases, all constants one prior deviation off, (p,)."""
        random = np.random.default_rng(0)
        z = random.choice([-1.0, 1.0], len(self._constants))
        shifted = self._exact(z)
        change = self._fitted({name: shifted[name] - self._start[name] for name in self._model.outputs_})
        points = draws.points(self._study, _CHECKED, (self._study.validation.seed, 11), _TOGETHER)
        exact = factorial.training_data(self._study, factorial.exact(moved(self._study, self._constants, z), points))
        X = np.stack([points[name].values for name in self._model.box], -1)
        predicted = self._model.predict_array(X) + change.predict_array(X)
        truth = np.stack([exact[name].values for name in self._model.outputs_], -1)
        return np.asarray(np.sqrt(np.mean((truth - predicted) ** 2, axis=0)))


def _levels(study: Study, model: GaussianProcess) -> dict[str, Array]:
    """Levels of every factor, tabled ones first, as many as the surrogate's own outputs ask for."""
    films = bool(study.tabled)
    try:
        pilot = explore(
            lambda axes: model.predict(axes, return_std=False), model.inputs_, _TOLERANCE[films], _BUDGET
        ).choice.counts
    except UnreachableError as error:
        raise InputError(f"{study.path}: effects of constants need too many cases: {error}") from None
    counts = {name: min(n if name in study.tabled else n + 1, _MOST_LEVELS) for name, n in pilot.items()}
    return {name: model.box[name].levels(counts[name]) for name in dict.fromkeys([*study.tabled, *counts])}


def _expanded(solved: xr.Dataset, held: dict[str, str]) -> xr.Dataset:
    """Cases of some categories' names with these categories as dimensions again."""
    return solved.drop_vars(list(held), errors="ignore").expand_dims({name: [value] for name, value in held.items()})
