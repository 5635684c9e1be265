"""Measured rows correct a study's surrogate, through the effects of uncertain constants and discrepancies."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import xarray as xr
from scipy.special import bdtr

from approximation.arrays import Array, Flags
from solver import MaterialError, find
from surrogate import GaussianProcess, GridGP
from surrogate.intervals.distribution import NOMINAL, Normal
from surrogate.levels.counts import UnreachableError, explore
from surrogate.transforms.measured import MOST_ROWS, CorrectedGP, Measurements
from surrogate.use import learning
from surrogate.use.learning import ROUNDS, Learnt
from workflow.dataset import draws, factorial
from workflow.study import categories, uncertainty
from workflow.study.model import Study
from workflow.study.reading import InputError, located
from workflow.study.uncertainty import Constant, concerned, members, moved

#: Posterior over prior standard deviation: above the first nothing is learned, below the second much is.
UNDETERMINED, DETERMINED = 0.8, 0.5
#: Odds for an explanation from which on it is real, and up to which none was seen.
REAL, UNSEEN = 20.0, 3.0
#: Probability from which on a value is an outlier.
OUTLIER = REAL / (1 + REAL)
#: True over stated errors that are reported: where the 95 % interval is beyond.
LARGER, SMALLER = 1.2, 0.8
#: Rows below which explanations are not distinguished: statements on constants rest on the priors of all.
FEW = 10
_COUNTED = (("rows", "row"), ("values", "measured value"))
_RARE = 0.01  # chance of so few rows within their intervals from which on they disagree


def summarised(
    posterior: Learnt,
    rows: Measurements,
    unknown: list[Constant],
    single: Flags,
    model: GaussianProcess,
    nominal: Array,
) -> dict[str, Any]:
    """Return the results as plain data: marks of single constants, (k,), means at the measured values, (n,)."""
    constants, count = _constants(posterior, unknown), len(np.unique(rows.row))
    content = {
        "rows": count,
        "values": len(rows.value),
        "constants": [constant for constant, alone in zip(constants, single, strict=True) if not alone],
        "single_constants": [constant for constant, alone in zip(constants, single, strict=True) if alone],
        "known_together": _combinations(posterior, unknown),
        "discrepancies": [_discrepancy(posterior, rows, model, nominal, q) for q in rows.outputs],
        "errors": [_errors(posterior, model, q) for q in rows.outputs if np.isfinite(rows.error[rows.of(q)]).any()],
        "outliers": _outliers(posterior, rows, model),
        "left_out": _left_out(posterior, rows, nominal),
    }
    if count < FEW:
        content |= {"discrepancies": [], "errors": [], "outliers": []}
    elif single.any():
        what = "single constants are off beside their families"
        words = f"{what} ({_odds_text(posterior.own_odds)})"
        verdict = _verdict(posterior.own_odds, words, f"not seen: {words}", f"neither shown nor excluded: {words}")
        content["single_constants_off"] = {"what": what, **verdict}
    return content | {"not_told_apart": _open(content)}


def in_words(content: Mapping[str, Any]) -> list[str]:
    """Return the results in words, a line each."""
    left = content["left_out"]
    constants = [*content["constants"], *content["single_constants"]]
    moved = [c for c in constants if c["posterior_over_prior"] <= UNDETERMINED]
    undetermined = [c["name"] for c in content["constants"] if c["posterior_over_prior"] > UNDETERMINED]
    rows, values = (f"{content[key]} {word}{'s' * (content[key] > 1)}" for key, word in _COUNTED)
    lines = [f"{rows}, {values}"]
    for c in sorted(moved, key=lambda c: c["posterior_over_prior"]):
        lines.append(
            f"{c['name']}: moved by {c['mean']:+.2f} +- {c['std']:.2f} prior standard deviations ({c['change']}, "
            f"prior {c['prior']})"
        )
    lines += [] if moved else ["no constant was learnt"]
    if undetermined:
        lines.append(f"not identifiable, as before the measurement: {', '.join(undetermined)}")
    for c in content["known_together"]:
        lines.append(f"known only together, to {c['posterior_over_prior']:.2f} of the prior: {c['combination']}")
    lines += [content["single_constants_off"]["verdict"]] if "single_constants_off" in content else []
    lines += [f"{d['output']}: {d['verdict']}" for d in content["discrepancies"]]
    lines += [f"{e['output']}: {e['verdict']}" for e in content["errors"] if e["verdict"]]
    lines += [o["verdict"] for o in content["outliers"]]
    if content["not_told_apart"]:
        lines.append(f"these rows neither show nor exclude: {'; '.join(content['not_told_apart'])}")
    if content["rows"] < FEW:
        lines.append(
            f"fewer than {FEW} rows: constants, a discrepancy, errors and outliers are not told apart; what is "
            "said of constants rests on the priors of all four"
        )
    if content["rows"] == 1:
        return lines
    lines.append(
        f"each row predicted from the others: {100 * left['share_within_95']:.1f} % of the values within 95 % "
        f"intervals, errors {left['rms_after']:.2g} of what they were before"
    )
    if left["disagree"]:
        lines.append("rows left out disagree with what the others say: what is told above does not hold as it is")
    return lines


def _odds_text(odds: float) -> str:
    """Return odds in words, at most as many as there are draws."""
    if odds > ROUNDS:
        return f"more than {ROUNDS} to 1"
    return f"less than 1 to {ROUNDS}" if odds < 1 / ROUNDS else f"odds {odds:.2g} to 1"


def _verdict(odds: float, real: str, unseen: str, undecided: str) -> dict[str, Any]:
    """Return the odds for an explanation, and one of three verdicts."""
    verdict = real if odds > REAL else unseen if odds < UNSEEN else undecided
    return {"odds": min(max(odds, 1 / ROUNDS), float(ROUNDS)), "verdict": verdict}


def _constants(posterior: Learnt, constants: list[Constant]) -> list[dict[str, Any]]:
    rows = zip(constants, posterior.mean.tolist(), posterior.contraction.tolist(), strict=True)
    return [
        {
            "name": constant.name, "prior": constant.prior, "mean": mean, "std": std, "change": constant.change(mean),
            "posterior_over_prior": std,
        }
        for constant, mean, std in rows
    ]  # fmt: skip


def _combinations(posterior: Learnt, constants: list[Constant]) -> list[dict[str, Any]]:
    """Return combinations of constants that the rows determine, though no constant in them alone."""
    known = []
    for contraction, direction in zip(posterior.directions[0], posterior.directions[1].T, strict=True):
        parts = np.flatnonzero(np.abs(direction) > 0.3)
        if contraction < DETERMINED and len(parts) > 1 and posterior.contraction[parts].min() > DETERMINED:
            sign = np.sign(direction[parts[np.abs(direction[parts]).argmax()]])
            words = [f"{sign * direction[k]:+.2f} {constants[k].name}" for k in parts]
            known.append({"combination": " ".join(words), "posterior_over_prior": float(contraction)})
    return known


def _discrepancy(
    posterior: Learnt, rows: Measurements, model: GaussianProcess, nominal: Array, q: int
) -> dict[str, Any]:
    """Return the odds of an output's discrepancy, and its size at the measured points."""
    k = rows.of(q)
    size = float(np.sqrt(np.mean(nominal[k] ** 2)))
    values = []
    for draw in posterior.draws:
        discrepancy = draw.discrepancies[q]
        mean, by_constants, _ = discrepancy.at(discrepancy.points)
        values.append(mean - by_constants @ draw.mean)
    share = float(np.sqrt(np.mean(np.mean(values, axis=0) ** 2))) / size if size else 0.0
    said, percent = _odds_text(posterior.odds[q]), f"{100 * share:.2g} % of its size"
    verdict = _verdict(
        posterior.odds[q],
        f"a discrepancy that no constant explains is real ({said}), {percent}",
        f"no discrepancy is seen beside the constants ({said})",
        f"a discrepancy is neither shown nor excluded ({said}), {percent}",
    )
    return {"output": model.outputs_[q], "share_of_size": share, **verdict}


def _errors(posterior: Learnt, model: GaussianProcess, q: int) -> dict[str, Any]:
    """Return the factor by which errors are larger than stated."""
    median, low, high = posterior.scale(q)
    verdict = ""
    if low > LARGER or high < SMALLER:
        verdict = f"errors are {median:.2g} times those stated (95 %: {low:.2g} to {high:.2g})"
    return {"output": model.outputs_[q], "times_stated": median, "low": low, "high": high, "verdict": verdict}


def _outliers(posterior: Learnt, rows: Measurements, model: GaussianProcess) -> list[dict[str, Any]]:
    """Return the outliers with their rows."""
    outliers = []
    for k in np.flatnonzero(posterior.wild > OUTLIER).tolist():
        row, output = int(rows.row[k]) + 1, model.outputs_[rows.output[k]]
        deviation = float((rows.value[k] - posterior.left_out[0][k]) / posterior.left_out[1][k])
        odds = float(posterior.wild[k] / max(1 - posterior.wild[k], 1e-12))
        verdict = (
            f"row {row}, {output}: an outlier ({_odds_text(odds)}), {deviation:+.1f} standard deviations from what the "
            "other rows say; it counts for little"
        )
        outliers.append(
            {"row": row, "output": output, "away": deviation, "odds": min(odds, float(ROUNDS)), "verdict": verdict}
        )
    return outliers


def _open(content: dict[str, Any]) -> list[str]:
    """Return explanations that the rows neither show nor exclude."""
    unresolved = [
        f"a discrepancy of {row['output']} ({_odds_text(row['odds'])})"
        for row in content["discrepancies"]
        if UNSEEN <= row["odds"] <= REAL
    ]
    unresolved += [
        f"errors of {row['output']} {row['times_stated']:.2g} times those stated"
        for row in content["errors"]
        if row["low"] <= LARGER < row["times_stated"]
    ]
    singles = content.get("single_constants_off")
    if singles and UNSEEN <= singles["odds"] <= REAL:
        unresolved.append(f"{singles['what']} ({_odds_text(singles['odds'])})")
    return unresolved


def _left_out(posterior: Learnt, rows: Measurements, nominal: Array) -> dict[str, Any]:
    """Return the errors of predicting every row from the others, over the surrogate's before; without outliers."""
    predicted, std = posterior.left_out
    regular = posterior.wild <= OUTLIER
    reach = float(Normal().ends(NOMINAL)[1, 0])
    after, before = np.abs(rows.value - predicted), np.abs(rows.value - nominal)
    inside = (after <= reach * std)[regular]
    ratios = []
    for q in rows.outputs:
        k = rows.of(q)
        k = k[regular[k]]
        ratios.append(np.sqrt(np.mean(after[k] ** 2) / np.mean(before[k] ** 2)) if len(k) else 1.0)
    chance = float(bdtr(inside.sum(), len(inside), NOMINAL))
    share = float(np.mean(inside)) if len(inside) else 0.0
    return {"share_within_95": share, "rms_after": float(np.median(ratios)), "disagree": chance < _RARE}


_WRONG_UNIT = 30.0  # measured over predicted values, as a factor, by which no constant changes a quantity
_TURNED = 0.9  # share of readings with the opposite sign from which the sign is the instrument's
_VAGUE = 1e9  # an error of measurement over the largest value: beyond it a row says nothing, and squares overflow
_PRIOR_STEP = 0.25  # prior standard deviations, of the difference that a derivative is taken from
_STALE = {True: 1.0, False: 0.1}  # largest move of constants before derivatives are taken anew; films: True
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
) -> tuple[CorrectedGP, dict[str, Any]]:
    """Correct a study's surrogate by measured rows."""
    count = len(np.unique(rows.row))
    if not 1 <= count <= MOST_ROWS:
        raise InputError(f"{count} rows with a measured value; must be 1 to {MOST_ROWS}")
    nominal = model.predict_array(rows.points)
    lower, upper = model.interval_array(rows.points, NOMINAL)
    mean = nominal[rows.row, rows.output]
    _check_size(model, rows, mean)
    singles = uncertainty.own(study, constants)
    unknown = [*constants, *singles]
    effects = ConstantEffects(study, model, unknown, say)
    own_error = np.maximum(upper - nominal, nominal - lower)[rows.row, rows.output] / Normal().ends(NOMINAL)[1, 0]
    spread = np.hypot(own_error, effects.error[rows.output])
    latest: list[GaussianProcess] = []
    single = np.array([constant in singles for constant in unknown], np.bool_)

    def forward(z: Array) -> tuple[Array, Array]:
        moves = ", ".join(f"{value:+.2f}" for value in z[: len(constants)])
        say(f"constants at {moves} prior standard deviations")
        latest[:] = [effects.at(z)]
        predicted = latest[0].predict_array(rows.points).reshape(len(rows.points), len(model.outputs_), -1)
        own_error = predicted[rows.row, rows.output]
        return mean + own_error[:, 0], own_error[:, 1:]

    try:
        posterior = learning.learn(forward, rows, model.inputs_, len(unknown), spread, single)
    except (learning.NotSettledError, MaterialError) as error:
        raise InputError(str(error)) from None
    summary = summarised(posterior, rows, unknown, single, model, mean)
    names = {constant.name: constant.prior for constant in unknown}
    surrogate = CorrectedGP(
        model, latest[0], names, posterior.about, posterior.draws, rows, effects.error, "\n".join(in_words(summary))
    )
    return surrogate, summary


def _check_size(model: GaussianProcess, rows: Measurements, mean: Array) -> None:
    """Refuse values of another sign convention or unit than the surrogate's, and errors far larger than the values."""
    for q in rows.outputs:
        k = rows.of(q)
        measured, predicted = rows.value[k], mean[k]
        name, units = model.outputs_[q], model.attrs_[model.outputs_[q]].get("units", "")
        most_vague = _VAGUE * float(np.abs([measured, predicted]).max())
        if (vague := rows.error[k][rows.error[k] > most_vague]).size:
            raise InputError(f"{name}: an error of {vague[0]:g} {units}; must be at most {most_vague:.2g} {units}")
        ratio = float(np.median(np.abs(measured)) / max(float(np.median(np.abs(predicted))), 1e-300))
        noise = np.nanmedian(rows.error[k]) if np.isfinite(rows.error[k]).any() else 0.0
        if float(np.median(np.abs(predicted))) < 3 * noise * min(1.0, 1 / ratio if ratio else 1.0):
            continue  # nothing but noise was to be measured
        large = np.abs(measured) > 3 * noise
        opposite = bool(large.any()) and float(np.mean(measured[large] * predicted[large] < 0)) > _TURNED
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


Variables = dict[str, xr.Variable]


class ConstantEffects:
    """Changes of all outputs of a surrogate by its constants, as surrogates over the same box."""

    def __init__(
        self,
        study: Study,
        model: GaussianProcess,
        constants: list[Constant],
        say: Callable[[str], None],
    ) -> None:
        self._study, self._model, self._constants, self._say = study, model, constants, say
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
        self._centre = np.zeros(len(constants))
        self._slopes = self._differences(self._centre, self._start)
        self._latest: tuple[Array, GridGP] | None = None
        self.error = self._judged()

    @property
    def cases(self) -> int:
        """Number of cases that are solved for every constant."""
        return int(np.prod([len(level) for level in self._levels.values()])) * len(self._study.combinations)

    def at(self, z: Array) -> GridGP:
        """Return surrogates of each output's change at scaled constants, then of its derivatives by each of them."""
        if self._latest is not None and np.array_equal(z, self._latest[0]):
            return self._latest[1]
        exact = self._exact(z) if np.any(z) else self._start
        if np.abs(z - self._centre).max() > _STALE[bool(self._study.tabled)]:
            self._say("the constants have moved: their effects anew")
            self._centre, self._slopes = z.copy(), self._differences(z, exact)
        parts = {}
        for name in self._model.outputs_:
            parts[f"{name}: change"] = exact[name] - self._start[name]
            for constant, slope in zip(self._constants, self._slopes, strict=True):
                parts[f"{name}: {constant.name}"] = slope[name]
        self._latest = z.copy(), self._fitted(parts)
        return self._latest[1]

    def _fitted(self, parts: Variables) -> GridGP:
        return GridGP(self._model.inputs_, list(parts), compression=1e-5).fit(xr.Dataset(parts, dict(self._levels)))

    def _exact(self, z: Array) -> Variables:
        study = moved(self._study, self._constants, z)
        return _variables(factorial.training_data(self._study, factorial.exact(study, dict(self._levels))))

    def _differences(self, z: Array, exact: Variables) -> list[Variables]:
        """Return the derivatives of all outputs by every scaled constant."""
        differences: dict[str, Variables] = {}
        solved = [constant for constant in self._constants if not self._parts(constant)]
        for number, constant in enumerate(solved, 1):
            self._say(f"{number} of {len(solved)}: {constant.name}")
            k = self._constants.index(constant)
            step = z + _PRIOR_STEP * np.eye(len(z))[k]
            held = concerned(self._study, constant)
            cases = factorial.exact(moved(self._study, self._constants, step).narrowed(held), dict(self._levels))
            categories_ = {
                name: [held[name]] if name in held else names for name, names in self._study.categories.items()
            }
            shifted = _variables(categories.apart(_expanded(cases, held), categories_, self._study.outputs))
            differences[constant.name] = {
                name: (shifted[name] - exact[name]) / _PRIOR_STEP if name in shifted else xr.zeros_like(exact[name])
                for name in self._model.outputs_
            }
        for family in self._constants:
            for part in self._parts(family):
                ratio, before = family.std / part.std, differences.get(family.name)
                share = {name: array * ratio for name, array in differences[part.name].items()}
                differences[family.name] = (
                    share if before is None else {name: before[name] + share[name] for name in share}
                )
        return [differences[constant.name] for constant in self._constants]

    def _parts(self, constant: Constant) -> list[Constant]:
        """Return the members of a family if each of them is uncertain as well, else nothing."""
        names = members(find(constant.material, self._study.own_materials), constant.family)
        parts = [other for other in self._constants if other.material == constant.material and other.family in names]
        return parts if len(parts) == len(names) else []

    def _judged(self) -> Array:
        """Return the effects' RMS error at random cases, all constants one prior deviation off, (output,)."""
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
    """Return the levels of every factor, tabled ones first, as many as the surrogate's outputs need."""
    films = bool(study.tabled)
    with located(f"{study.path}: effects of constants need too many cases", UnreachableError):
        pilot = explore(
            lambda axes: model.predict(axes, return_std=False), model.inputs_, _TOLERANCE[films], _BUDGET
        ).choice.counts
    counts = {name: min(n if name in study.tabled else n + 1, _MOST_LEVELS) for name, n in pilot.items()}
    return {name: model.box[name].levels(counts[name]) for name in dict.fromkeys([*study.tabled, *counts])}


def _variables(data: xr.Dataset) -> Variables:
    """Return outputs as variables, which subtract faster than arrays; all have the same levels."""
    return {str(name): array.variable for name, array in data.data_vars.items()}


def _expanded(solved: xr.Dataset, held: dict[str, str]) -> xr.Dataset:
    """Return cases at fixed names of categories, with these categories as dimensions."""
    return solved.drop_vars(list(held), errors="ignore").expand_dims({name: [value] for name, value in held.items()})
