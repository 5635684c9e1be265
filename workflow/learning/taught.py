"""What measured rows have taught, in words and as plain data."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from surrogate import GaussianProcess
from surrogate.data.measurements import Measurements
from surrogate.intervals.distribution import NOMINAL, Normal
from surrogate.use.learning import Learnt
from workflow.study.uncertainty import Constant

Array = NDArray[np.float64]

#: Posterior over prior standard deviation: above it nothing was learnt, below it a combination is well known.
UNTOLD, TOLD = 0.8, 0.5
#: Odds for a discrepancy from which on it is real, and up to which none was seen.
REAL, UNSEEN = 20.0, 3.0


@dataclass(frozen=True)
class Taught:
    """What measured rows have taught.

    Attributes
    ----------
    plain : dict
        Of numbers, texts, lists: as JSON.
    """

    plain: dict[str, Any]

    @classmethod
    def of(
        cls, found: Learnt, rows: Measurements, constants: list[Constant], model: GaussianProcess, nominal: Array
    ) -> Self:
        """What was learnt about constants of a model whose nominal means at the measured values are given."""
        return cls(
            {
                "rows": len(np.unique(rows.row)),
                "values": len(rows.value),
                "constants": _constants(found, constants),
                "known_together": _combinations(found, constants),
                "discrepancies": [_discrepancy(found, rows, model, nominal, q) for q in rows.outputs],
                "left_out": _left_out(found, rows, nominal),
            }
        )

    @property
    def lines(self) -> list[str]:
        """In words, a line each."""
        one, left = self.plain, self.plain["left_out"]
        moved = [c for c in one["constants"] if c["posterior_over_prior"] <= UNTOLD]
        untold = [c["name"] for c in one["constants"] if c["posterior_over_prior"] > UNTOLD]
        lines = [f"{one['rows']} rows, {one['values']} measured values"]
        for c in sorted(moved, key=lambda c: c["posterior_over_prior"]):
            lines.append(
                f"{c['name']}: moved by {c['mean']:+.2f} +- {c['std']:.2f} prior standard deviations ({c['change']}, "
                f"prior {c['prior']})"
            )
        lines += [] if moved else ["no constant was learnt"]
        if untold:
            lines.append(f"not identifiable, as before the measurement: {', '.join(untold)}")
        for c in one["known_together"]:
            lines.append(f"known only together, to {c['posterior_over_prior']:.2f} of the prior: {c['combination']}")
        lines += [f"{d['output']}: {d['verdict']}" for d in one["discrepancies"]]
        lines.append(
            f"each row predicted from the others: {100 * left['share_within_95']:.1f} % of the values within 95 % "
            f"intervals, errors {left['rms_after']:.2g} of what they were before"
        )
        return lines


def _constants(found: Learnt, constants: list[Constant]) -> list[dict[str, Any]]:
    rows = zip(constants, found.mean.tolist(), found.contraction.tolist(), strict=True)
    return [
        {
            "name": one.name, "prior": one.prior, "mean": mean, "std": std, "change": one.change(mean),
            "posterior_over_prior": std,
        }
        for one, mean, std in rows
    ]  # fmt: skip


def _combinations(found: Learnt, constants: list[Constant]) -> list[dict[str, Any]]:
    """Directions that the rows know well though no constant in them is known alone."""
    known = []
    for contraction, direction in zip(found.directions[0], found.directions[1].T, strict=True):
        parts = np.flatnonzero(np.abs(direction) > 0.3)
        if contraction < TOLD and len(parts) > 1 and found.contraction[parts].min() > TOLD:
            sign = np.sign(direction[parts[np.abs(direction[parts]).argmax()]])
            words = [f"{sign * direction[k]:+.2f} {constants[k].name}" for k in parts]
            known.append({"combination": " ".join(words), "posterior_over_prior": float(contraction)})
    return known


def _discrepancy(found: Learnt, rows: Measurements, model: GaussianProcess, nominal: Array, q: int) -> dict[str, Any]:
    """Whether an output has a discrepancy, and how large it is at the measured points."""
    k, odds = rows.of(q), found.odds[q]
    size = float(np.sqrt(np.mean(nominal[k] ** 2)))
    values = []
    for draw in found.draws:
        one = draw.discrepancies[q]
        own, by_constants, _ = one.at(one.points)
        values.append(own - by_constants @ draw.mean)
    share = float(np.sqrt(np.mean(np.mean(values, axis=0) ** 2))) / size if size else 0.0
    said = f"odds {np.exp(min(odds, 50.0)):.3g} to 1"
    if odds > np.log(REAL):
        verdict = f"a discrepancy that no constant explains is real ({said}), {100 * share:.2g} % of its size"
    elif odds < np.log(UNSEEN):
        verdict = f"no discrepancy is seen beside the constants ({said})"
    else:
        verdict = f"a discrepancy is neither shown nor excluded ({said}), {100 * share:.2g} % of its size"
    return {"output": model.outputs_[q], "log_odds": odds, "share_of_size": share, "verdict": verdict}


def _left_out(found: Learnt, rows: Measurements, nominal: Array) -> dict[str, Any]:
    """How well every row is predicted from the others, beside the surrogate before."""
    predicted, std = found.left_out
    reach = float(Normal().ends(NOMINAL)[1, 0])
    after, before = np.abs(rows.value - predicted), np.abs(rows.value - nominal)
    ratios = [np.sqrt(np.mean(after[rows.of(q)] ** 2) / np.mean(before[rows.of(q)] ** 2)) for q in rows.outputs]
    return {"share_within_95": float(np.mean(after <= reach * std)), "rms_after": float(np.median(ratios))}
