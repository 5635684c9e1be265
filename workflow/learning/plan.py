"""Which further measurements tell most of a study's constants, after those that a surrogate was corrected by."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from surrogate import GaussianProcess
from surrogate.data.inputs import unit_coordinates
from surrogate.data.measurements import Measurements
from surrogate.transforms.measured.corrected import CorrectedGP
from surrogate.use import planning
from workflow.learning.instruments import Instrument, shown
from workflow.study import categories
from workflow.study.reading import InputError

Array = NDArray[np.float64]

#: Readings that a plan is chosen from, and how many it may have.
CANDIDATES, MOST = 400, 100
_USUAL = 0.01  # of the value: the error of a reading where the rows state none
_DRAWS, _RANDOM = 4, 20  # of the posterior that a plan is chosen on; random plans beside it


@dataclass(frozen=True)
class Plan:
    """Further measurements.

    Attributes
    ----------
    rows : list of dict
        Factors by name, and the ``output`` to be measured.
    wanted : list of dict
        Of every constant that they are to tell: ``name``, and its posterior over prior deviation ``now``, ``planned``
        and after as many ``random`` measurements.
    """

    rows: list[dict[str, float | str]]
    wanted: list[dict[str, Any]]

    @property
    def plain(self) -> dict[str, Any]:
        """As JSON."""
        return {"rows": self.rows, "constants": self.wanted}

    @property
    def lines(self) -> list[str]:
        """In words, a line each, and the table."""
        found = [
            f"{len(self.rows)} further measurements leave {constant['planned']:.2f} of the prior of {constant['name']} "
            f"({constant['now']:.2f} now, {constant['random']:.2f} after as many at random)"
            for constant in self.wanted
        ]
        found.append(",".join([*[name for name in self.rows[0] if name != "output"], "measure"]))
        for row in self.rows:
            values = [f"{value:.4g}" for name, value in row.items() if name != "output"]
            found.append(",".join([*values, str(row["output"])]))
        return found


def check(
    model: GaussianProcess,
    count: int,
    wanted: list[str],
    known: list[str],
    errors: Mapping[str, tuple[float, float]],
    box: Mapping[str, tuple[float, float]],
) -> None:
    """Raise InputError, before anything is learnt, for a plan that a surrogate with these unknowns cannot give.

    That is none or too many measurements, names that it has not, or ends outside of its trained box.
    """
    if not 1 <= count <= MOST:
        raise InputError(f"--plan: {count} measurements; must be 1 to {MOST}")
    for name in wanted:
        if name not in known:
            raise InputError(f"--for: {name!r} is not among the unknowns {', '.join(known)}")
    quantities = dict.fromkeys(categories.parted(name)[0] for name in model.outputs_)
    for name in errors:
        if name not in quantities:
            raise InputError(f"--errors: {name!r} is none of {', '.join(quantities)}")
    for name, (low, high) in box.items():
        if name not in model.box:
            raise InputError(f"--within: {name!r} is none of {', '.join(model.box)}")
        axis = model.box[name]
        if not axis.low <= low < high <= axis.high:
            raise InputError(f"--within: {name}: {low:g} to {high:g}; must ascend within [{axis.low:g}, {axis.high:g}]")


def plan(
    model: CorrectedGP,
    count: int,
    wanted: list[str],
    errors: Mapping[str, tuple[float, float]],
    box: Mapping[str, tuple[float, float]],
    instruments: list[Instrument],
) -> Plan:
    """Choose further measurements, D-optimal on the posterior of a corrected surrogate.

    Parameters
    ----------
    model
        The corrected surrogate.
    count
        How many.
    wanted
        Names of the constants that they are to tell.
    errors
        Of quantities that can be measured: deviation of a reading's error in SI, and as a share of its value. Without
        any, what was measured, with the median of the errors that were stated.
    box
        Ends of factors, in their units, within which measurements can be made; others have their trained range.
    instruments
        Those that the surrogate was corrected with; they read further measurements too.
    """
    names = list(model.constants_)
    outputs = _outputs(model, errors)
    points = _points(model, box, -(-CANDIDATES // len(outputs)))
    output = np.tile(np.array(list(outputs), np.intp), len(points))
    where = np.repeat(np.arange(len(points)), len(outputs))
    readings = Measurements(points, where, output, np.zeros(len(where)), np.full(len(where), np.nan))
    mean = model.predict_array(points)[where, output]
    absolute, share = np.array([outputs[q] for q in output.tolist()]).T
    effect = model.effect_.predict_array(points).reshape(len(points), len(model.outputs_), -1)[where, output]
    about, physical = model.about_[len(names) - len(instruments) :], effect[:, 1 : 1 + len(names) - len(instruments)]
    slopes = shown(instruments, model, readings, about, mean, physical)[1]
    scaled = unit_coordinates(model.inputs_, points).T[where]
    draws = model.draws_[:: max(1, len(model.draws_) // _DRAWS)][:_DRAWS]
    joints = [planning.joint(draw, scaled, output, slopes) for draw in draws]
    noise = absolute**2 + (share * mean) ** 2 + 1e-24 * float(np.mean(mean**2)) + 1e-300
    places = np.array([names.index(name) for name in wanted], np.intp)
    chosen = planning.chosen(joints, noise, places, count)
    random = np.random.default_rng(0)
    others = [random.choice(len(noise), count, replace=False).tolist() for _ in range(_RANDOM)]
    now, planned = (planning.widths(joints, noise, rows, len(names)) for rows in ([], chosen))
    beside = np.median([planning.widths(joints, noise, other, len(names)) for other in others], axis=0)
    rows = []
    for k in chosen:
        row: dict[str, float | str] = dict(zip(model.box, points[where[k]].tolist(), strict=True))
        rows.append(row | {"output": model.outputs_[output[k]]})
    told = zip(wanted, now[places].tolist(), planned[places].tolist(), beside[places].tolist(), strict=True)
    keys = ("name", "now", "planned", "random")
    return Plan(rows, [dict(zip(keys, row, strict=True)) for row in told])


def _outputs(model: CorrectedGP, errors: Mapping[str, tuple[float, float]]) -> dict[int, tuple[float, float]]:
    """Outputs that can be measured, by number, with the absolute part and the share of their errors."""
    if errors:
        quantities = [categories.parted(name)[0] for name in model.outputs_]
        return {q: errors[name] for q, name in enumerate(quantities) if name in errors}
    found, rows = {}, model.rows_
    for q in rows.outputs:
        k = rows.of(q)
        stated = rows.error[k] / np.maximum(np.abs(rows.value[k]), 1e-300)
        found[q] = (0.0, float(np.nanmedian(stated)) if np.isfinite(stated).any() else _USUAL)
    return found


def _points(model: CorrectedGP, box: Mapping[str, tuple[float, float]], count: int) -> Array:
    """Points spread over the box, its middle and ends of every factor among them, (m, d)."""
    d = len(model.inputs_)
    t = 2 * qmc.Sobol(d, rng=0).random(1 << (count - 1).bit_length())[:count] - 1
    t[: count // 2] = np.clip(1.5 * t[: count // 2], -1, 1)  # what tells most often stands at an end
    points = np.empty_like(t)
    for k, axis in enumerate(model.inputs_):
        low, high = axis.to_unit(np.array(box.get(axis.name, (axis.low, axis.high))))
        points[:, k] = np.clip(axis.from_unit(low + (t[:, k] + 1) / 2 * (high - low)), axis.low, axis.high)
    return points
