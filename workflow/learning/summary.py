"""Results of learning from measured rows, in words and as plain data."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from scipy.stats import binom

from approximation.arrays import Array, Flags
from surrogate import GaussianProcess
from surrogate.data.measurements import Measurements
from surrogate.intervals.distribution import NOMINAL, Normal
from surrogate.use.learning import ROUNDS, Learnt
from workflow.learning.instruments import Instrument
from workflow.study.uncertainty import Constant

Unknown = Constant | Instrument

#: Posterior over prior standard deviation: above it nothing was learned, below it a combination is well known.
UNTOLD, TOLD = 0.8, 0.5
#: Odds for an explanation from which on it is real, and up to which none was seen.
REAL, UNSEEN = 20.0, 3.0
#: Probability from which on a value is named an outlier.
NAMED = REAL / (1 + REAL)
#: True over stated errors that are told: where the 95 % interval is beyond.
LARGER, SMALLER = 1.2, 0.8
#: Rows below which no explanation is told from another: what is said of constants rests on the priors of all.
FEW = 10
_COUNTED = (("rows", "row"), ("values", "measured value"))
_RARE = 0.01  # chance of so few rows within their intervals from which on they disagree


def understated(posterior: Learnt, output: int) -> bool:
    """Return whether errors are reported as larger than stated."""
    return posterior.scale(output)[1] > LARGER


@dataclass(frozen=True)
class Summary:
    """Results of learning from measured rows."""

    plain: dict[str, Any]  # Of numbers, texts, lists: as JSON

    @classmethod
    def of(
        cls,
        posterior: Learnt,
        rows: Measurements,
        unknown: list[Unknown],
        single: Flags,
        model: GaussianProcess,
        nominal: Array,
    ) -> Self:
        """Results as plain data, with marks of single constants, (k,), and means at the measured values, (n,)."""
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
            content["single_constants_off"] = _verdict(
                "single constants are off beside their families", posterior.own_odds
            )
        return cls(content | {"not_told_apart": _open(content)})

    @property
    def lines(self) -> list[str]:
        """Return the results in words, a line each."""
        content, left = self.plain, self.plain["left_out"]
        constants = [*content["constants"], *content["single_constants"]]
        moved = [c for c in constants if c["posterior_over_prior"] <= UNTOLD]
        untold = [c["name"] for c in content["constants"] if c["posterior_over_prior"] > UNTOLD]
        rows, values = (f"{content[key]} {word}{'s' * (content[key] > 1)}" for key, word in _COUNTED)
        lines = [f"{rows}, {values}"]
        for c in sorted(moved, key=lambda c: c["posterior_over_prior"]):
            lines.append(
                f"{c['name']}: moved by {c['mean']:+.2f} +- {c['std']:.2f} prior standard deviations ({c['change']}, "
                f"prior {c['prior']})"
            )
        lines += [] if moved else ["no constant was learnt"]
        if untold:
            lines.append(f"not identifiable, as before the measurement: {', '.join(untold)}")
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


def _odds_said(odds: float) -> str:
    """Odds in words, never more than as many draws as there are can tell."""
    if odds > ROUNDS:
        return f"more than {ROUNDS} to 1"
    return f"less than 1 to {ROUNDS}" if odds < 1 / ROUNDS else f"odds {odds:.2g} to 1"


def _verdict(what: str, odds: float) -> dict[str, Any]:
    """Return whether an explanation is needed."""
    said = _odds_said(odds)
    if odds > REAL:
        verdict = f"{what} ({said})"
    elif odds < UNSEEN:
        verdict = f"not seen: {what} ({said})"
    else:
        verdict = f"neither shown nor excluded: {what} ({said})"
    return {"what": what, "odds": min(max(odds, 1 / ROUNDS), float(ROUNDS)), "verdict": verdict}


def _constants(posterior: Learnt, constants: list[Unknown]) -> list[dict[str, Any]]:
    rows = zip(constants, posterior.mean.tolist(), posterior.contraction.tolist(), strict=True)
    return [
        {
            "name": constant.name, "prior": constant.prior, "mean": mean, "std": std, "change": constant.change(mean),
            "posterior_over_prior": std,
        }
        for constant, mean, std in rows
    ]  # fmt: skip


def _combinations(posterior: Learnt, constants: list[Unknown]) -> list[dict[str, Any]]:
    """Directions that the rows know well though no constant in them is known alone."""
    known = []
    for contraction, direction in zip(posterior.directions[0], posterior.directions[1].T, strict=True):
        parts = np.flatnonzero(np.abs(direction) > 0.3)
        if contraction < TOLD and len(parts) > 1 and posterior.contraction[parts].min() > TOLD:
            sign = np.sign(direction[parts[np.abs(direction[parts]).argmax()]])
            words = [f"{sign * direction[k]:+.2f} {constants[k].name}" for k in parts]
            known.append({"combination": " ".join(words), "posterior_over_prior": float(contraction)})
    return known


def _discrepancy(
    posterior: Learnt, rows: Measurements, model: GaussianProcess, nominal: Array, q: int
) -> dict[str, Any]:
    """Return the odds of an output's discrepancy, and its size at the measured points."""
    k, odds = rows.of(q), posterior.odds[q]
    size = float(np.sqrt(np.mean(nominal[k] ** 2)))
    values = []
    for draw in posterior.draws:
        discrepancy = draw.discrepancies[q]
        mean, by_constants, _ = discrepancy.at(discrepancy.points)
        values.append(mean - by_constants @ draw.mean)
    share = float(np.sqrt(np.mean(np.mean(values, axis=0) ** 2))) / size if size else 0.0
    said = _odds_said(odds)
    if odds > REAL:
        verdict = f"a discrepancy that no constant explains is real ({said}), {100 * share:.2g} % of its size"
    elif odds < UNSEEN:
        verdict = f"no discrepancy is seen beside the constants ({said})"
    else:
        verdict = f"a discrepancy is neither shown nor excluded ({said}), {100 * share:.2g} % of its size"
    odds = min(max(odds, 1 / ROUNDS), float(ROUNDS))
    return {"output": model.outputs_[q], "odds": odds, "share_of_size": share, "verdict": verdict}


def _errors(posterior: Learnt, model: GaussianProcess, q: int) -> dict[str, Any]:
    """Return the factor by which errors are larger than stated."""
    median, low, high = posterior.scale(q)
    verdict = ""
    if low > LARGER or high < SMALLER:
        verdict = f"errors are {median:.2g} times those stated (95 %: {low:.2g} to {high:.2g})"
    return {"output": model.outputs_[q], "times_stated": median, "low": low, "high": high, "verdict": verdict}


def _outliers(posterior: Learnt, rows: Measurements, model: GaussianProcess) -> list[dict[str, Any]]:
    """Values that do not belong to the others, each with its row."""
    named = []
    for k in np.flatnonzero(posterior.wild > NAMED).tolist():
        row, output = int(rows.row[k]) + 1, model.outputs_[rows.output[k]]
        deviation = float((rows.value[k] - posterior.left_out[0][k]) / posterior.left_out[1][k])
        odds = float(posterior.wild[k] / max(1 - posterior.wild[k], 1e-12))
        verdict = (
            f"row {row}, {output}: an outlier ({_odds_said(odds)}), {deviation:+.1f} standard deviations from what the "
            "other rows say; it counts for little"
        )
        named.append(
            {"row": row, "output": output, "away": deviation, "odds": min(odds, float(ROUNDS)), "verdict": verdict}
        )
    return named


def _open(content: dict[str, Any]) -> list[str]:
    """Explanations that the rows do not decide between."""
    unresolved = [
        f"a discrepancy of {row['output']} ({_odds_said(row['odds'])})"
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
        unresolved.append(f"{singles['what']} ({_odds_said(singles['odds'])})")
    return unresolved


def _left_out(posterior: Learnt, rows: Measurements, nominal: Array) -> dict[str, Any]:
    """Return the errors of predicting every row from the others, and the surrogate's before; without outliers."""
    predicted, std = posterior.left_out
    usual = posterior.wild <= NAMED
    reach = float(Normal().ends(NOMINAL)[1, 0])
    after, before = np.abs(rows.value - predicted), np.abs(rows.value - nominal)
    inside = (after <= reach * std)[usual]
    ratios = []
    for q in rows.outputs:
        k = rows.of(q)
        k = k[usual[k]]
        ratios.append(np.sqrt(np.mean(after[k] ** 2) / np.mean(before[k] ** 2)) if len(k) else 1.0)
    chance = float(binom.cdf(inside.sum(), len(inside), NOMINAL))
    share = float(np.mean(inside)) if len(inside) else 0.0
    return {"share_within_95": share, "rms_after": float(np.median(ratios)), "disagree": chance < _RARE}
