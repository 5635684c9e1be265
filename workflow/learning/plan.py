"""Which further measurements tell most of constants or answers, after those that a surrogate was corrected by."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from approximation.arrays import Array, Indices
from surrogate import GaussianProcess
from surrogate.data.inputs import unit_coordinates
from surrogate.data.measurements import Measurements
from surrogate.transforms.measured.corrected import CorrectedGP
from surrogate.use import planning
from workflow.language.numbers import shown as written
from workflow.learning.instruments import Instrument, shown
from workflow.study import categories
from workflow.study.reading import InputError

#: Readings that a plan is chosen from, and how many it may have.
CANDIDATES, MOST = 400, 100
_USUAL = 0.01  # of the value: the error of a reading where the rows state none
_DRAWS, _RANDOM = 4, 20  # of the posterior that a plan is chosen on; random plans beside it


@dataclass(frozen=True)
class Plan:
    """Further measurements."""

    rows: list[dict[str, float | str]]  # Factors by name, and the ``output`` to be measured
    # Of every constant that they are to tell: ``name``, and its posterior over prior deviation ``now``, ``planned``
    # and after as many ``random`` measurements
    constants: list[dict[str, Any]]
    answers: list[dict[str, Any]]  # The same of every answer; deviations in its ``units``

    @property
    def plain(self) -> dict[str, Any]:
        """As JSON."""
        return {"rows": self.rows, "constants": self.constants, "answers": self.answers}

    @property
    def lines(self) -> list[str]:
        """In words, a line each, and the table."""
        told = [
            f"{len(self.rows)} further measurements leave {constant['planned']:.2f} of the prior of {constant['name']} "
            f"({constant['now']:.2f} now, {constant['random']:.2f} after as many at random)"
            for constant in self.constants
        ]
        for answer in self.answers:
            planned, now, random = (written(answer[key], answer["units"], 3) for key in ("planned", "now", "random"))
            told.append(
                f"{len(self.rows)} further measurements leave +-{planned} of {answer['name']} "
                f"(+-{now} now, +-{random} after as many at random)"
            )
        told.append(",".join([*[name for name in self.rows[0] if name != "output"], "measure"]))
        for row in self.rows:
            values = [f"{value:.4g}" for name, value in row.items() if name != "output"]
            told.append(",".join([*values, str(row["output"])]))
        return told


def check(
    model: GaussianProcess,
    count: int,
    wanted: list[str],
    known: list[str],
    errors: Mapping[str, tuple[float, float]],
    box: Mapping[str, tuple[float, float]],
    at: Mapping[str, float],
) -> None:
    """Raise InputError, before anything is learned, for a plan that a surrogate with these unknowns cannot give.

    That is none or too many measurements, names that it has not, or ends outside of its trained box.
    """
    if not 1 <= count <= MOST:
        raise InputError(f"--plan: {count} measurements; must be 1 to {MOST}")
    quantities = dict.fromkeys(categories.parted(name)[0] for name in model.outputs_)
    for name in wanted:
        if name not in known and name not in model.outputs_:
            names = ", ".join(model.outputs_ if name in quantities else known)
            what = "outputs" if name in quantities else "unknowns"
            raise InputError(f"--for: {name!r} is not among the {what} {names}")
    _check_place([name for name in wanted if name not in known], model, at)
    for name in errors:
        if name not in quantities:
            raise InputError(f"--errors: {name!r} is none of {', '.join(quantities)}")
    for name, (low, high) in box.items():
        if name not in model.box:
            raise InputError(f"--within: {name!r} is none of {', '.join(model.box)}")
        axis = model.box[name]
        if not axis.low <= low < high <= axis.high:
            raise InputError(f"--within: {name}: {low:g} to {high:g}; must ascend within [{axis.low:g}, {axis.high:g}]")


def _check_place(answers: list[str], model: GaussianProcess, at: Mapping[str, float]) -> None:
    """Whether the place of answers is within the box, and given where there are any."""
    if at and not answers:
        raise InputError("--at: says where an answer is wanted; --for names none")
    for name in at:
        if name not in model.box:
            raise InputError(f"--at: {name}: is none of {', '.join(model.box)}")
    for name, axis in model.box.items():
        if answers and name not in at:
            raise InputError(f"--at: {name}: missing; {answers[0]} is wanted at one place of {', '.join(model.box)}")
        if answers and not axis.low <= at[name] <= axis.high:
            raise InputError(f"--at: {name}: {at[name]:g}; must be within [{axis.low:g}, {axis.high:g}]")


def plan(
    model: CorrectedGP,
    count: int,
    wanted: list[str],
    errors: Mapping[str, tuple[float, float]],
    box: Mapping[str, tuple[float, float]],
    at: Mapping[str, float],
    instruments: list[Instrument],
) -> Plan:
    """Choose further measurements, D-optimal on the posterior of a corrected surrogate."""
    names, known = list(model.constants_), set(model.constants_)
    answers = [name for name in wanted if name not in known]
    offers, asked = _outputs(model, errors), np.array([model.outputs_.index(name) for name in answers], np.intp)
    points = _points(model, box, -(-CANDIDATES // len(offers)))
    output = np.append(np.tile(np.array(list(offers), np.intp), len(points)), asked)
    where = np.append(np.repeat(np.arange(len(points)), len(offers)), np.full(len(asked), len(points)))
    if answers:
        points = np.concatenate([points, [[at[name] for name in model.box]]])
    count_read = len(where) - len(asked)
    mean, slopes = _shown(model, points, where, output, instruments, count_read)
    scaled = unit_coordinates(model.inputs_, points).T[where]
    draws = model.draws_[:: max(1, len(model.draws_) // _DRAWS)][:_DRAWS]
    joints = [planning.joint(draw, scaled, output, slopes) for draw in draws]
    absolute, share = np.array([offers[q] for q in output[:count_read].tolist()]).T
    noise = np.append(absolute**2 + (share * mean[:count_read]) ** 2, [np.inf] * len(asked))
    noise += 1e-24 * float(np.mean(mean**2)) + 1e-300
    column = {name: names.index(name) for name in wanted if name in known}
    column |= {name: len(names) + count_read + k for k, name in enumerate(answers)}
    rows = np.array([column[name] for name in wanted], np.intp)
    chosen = planning.chosen(joints, noise, rows, count)
    random, even = np.random.default_rng(0), np.flatnonzero(where[:count_read] >= np.max(where[:count_read]) // 2)
    plans = [[], chosen, *(random.choice(even, count, replace=len(even) < count).tolist() for _ in range(_RANDOM))]
    now, planned, *others = (planning.widths(joints, noise, taken, rows) for taken in plans)
    sizes = np.stack([now, planned, np.median(others, axis=0)], -1).tolist()
    told = {
        name: dict(zip(("now", "planned", "random"), size, strict=True))
        for name, size in zip(wanted, sizes, strict=True)
    }
    readings = [
        dict(zip(model.box, points[where[k]].tolist(), strict=True)) | {"output": model.outputs_[output[k]]}
        for k in chosen
    ]
    units = {name: str(model.attrs_[name].get("units", "1")) for name in answers}
    return Plan(
        readings,
        [{"name": name, **told[name]} for name in wanted if name in known],
        [{"name": name, **told[name], "units": unit} for name, unit in units.items()],
    )


def _shown(
    model: CorrectedGP, points: Array, where: Indices, output: Indices, instruments: list[Instrument], read: int
) -> tuple[Array, Array]:
    """Means of outputs at points, and derivatives by the unknowns of their instruments."""
    mean = np.asarray(model.predict_array(points)[where, output])
    effect = model.effect_.predict_array(points).reshape(len(points), len(model.outputs_), -1)[where, output, 1:]
    physical = len(model.constants_) - len(instruments)
    readings = Measurements(points, where, output, np.zeros(len(where)), np.full(len(where), np.nan))
    slopes = shown(instruments, model, readings, model.about_[physical:], mean, effect[:, :physical])[1]
    slopes[read:] = effect[read:]
    return mean, slopes


def _outputs(model: CorrectedGP, errors: Mapping[str, tuple[float, float]]) -> dict[int, tuple[float, float]]:
    """Outputs that can be measured, by number, with the absolute part and the share of their errors."""
    if errors:
        quantities = [categories.parted(name)[0] for name in model.outputs_]
        return {q: errors[name] for q, name in enumerate(quantities) if name in errors}
    offers, rows = {}, model.rows_
    for q in rows.outputs:
        k = rows.of(q)
        stated = rows.error[k] / np.maximum(np.abs(rows.value[k]), 1e-300)
        offers[q] = (0.0, float(np.nanmedian(stated)) if np.isfinite(stated).any() else _USUAL)
    return offers


def _points(model: CorrectedGP, box: Mapping[str, tuple[float, float]], count: int) -> Array:
    """Points spread over the box, the first half towards its ends, (m, d)."""
    t = planning.spread(len(model.inputs_), count)
    points = np.empty_like(t)
    for k, axis in enumerate(model.inputs_):
        low, high = axis.to_unit(np.array(box.get(axis.name, (axis.low, axis.high))))
        points[:, k] = np.clip(axis.from_unit(low + (t[:, k] + 1) / 2 * (high - low)), axis.low, axis.high)
    return points
