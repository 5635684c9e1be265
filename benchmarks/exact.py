"""Cost of the exact solver a case; of films also that of data sets of two sizes, of queries, and their errors.

Films are those of `config/film.yaml`, seven factors over groups; their times are processor time.
"""

import numpy as np
import xarray as xr

from benchmarks import timed
from workflow.dataset import factorial
from workflow.learning import training
from workflow.learning.timing import seconds
from workflow.run.provenance import ROOT
from workflow.study.model import Study, load, remade

#: Levels of volume fraction, friction, P R/h^2, T/P and J/P.
LEVELS = {"4,608 cases": (8, 4, 12, 4, 3), "36,800 cases": (16, 5, 23, 5, 4)}
BASES = ("rigid", "steel")
#: Fresh cases, those of the calibration, queries that are counted, and outputs that each of them asks for.
FRESH, CALIBRATION, QUERIES, OUTPUTS = 1000, 2500, 1_000_000, 21


def measure() -> dict[str, float]:
    """Seconds a case: every closed-form quantity at once, then the largest stresses of the body as well."""
    study = load(ROOT / "config/quickstart.yaml")
    axes = dict(factorial.levels(study))
    scattered = factorial.sample(study, 5000, (1, 0))
    points = {name: scattered[name] for name in study.factors}
    with_peaks = study.model_copy(update={"dataset": study.dataset.model_copy(update={"peaks": True})})
    few = {name: array[:300] for name, array in points.items()}
    small = {name: levels[:: max(1, len(levels) // 4)] for name, levels in axes.items()}
    size = int(np.prod([len(levels) for levels in small.values()]))
    return {
        "closed form, in a factorial": seconds(lambda: factorial.exact(study, axes)) / study.cases,
        "closed form, scattered": seconds(lambda: factorial.exact(study, points)) / 5000,
        "closed form, alone": seconds(lambda: factorial.exact(study, {n: a[:1] for n, a in points.items()})),
        "with the largest stresses, in a factorial": seconds(lambda: factorial.exact(with_peaks, small), 1) / size,
        "with the largest stresses, scattered": seconds(lambda: factorial.exact(with_peaks, few), 1) / 300,
        **films(),
    }


def films() -> dict[str, float]:
    """Seconds and largest errors over range on fresh cases, before and after the calibration, for every base."""
    whole = load(ROOT / "config" / "film.yaml")
    measured: dict[str, float] = {}
    for base in BASES:
        for name, levels in LEVELS.items():
            study = _alone(whole, base, levels)
            measured |= {f"{base}, {name}: {what}": value for what, value in _measured(study).items()}
    return measured


def _alone(whole: Study, base: str, levels: tuple[int, ...]) -> Study:
    """The study of films on one base, with these levels of its groups."""
    groups = {
        text: group.model_dump() | {"levels": count}
        for (text, group), count in zip(whole.groups.items(), levels, strict=True)
    }
    fixed = {**whole.fixed, "base": base}
    return remade(whole, fixed=fixed, categories={}, groups=groups, design={}, readout={})


def _measured(study: Study) -> dict[str, float]:
    """Return the costs of one data set, its fit and its queries, and the errors before and after the correction."""
    data, solved = timed(lambda: factorial.exact(study, factorial.axes(study)))
    model, fitted = timed(lambda: training.fit(study, data))
    truth, exact = timed(lambda: factorial.sample(study, FRESH, (1, 0)))
    points = {name: truth[name] for name in study.factors}
    true = factorial.training_data(study, truth)

    def error() -> float:
        errors = model.predict(points, return_std=False) - true
        return max(float(abs(errors[name]).max() / np.ptp(true[name].values)) for name in model.outputs_)

    plain = error()
    model.calibrate(factorial.training_data(study, factorial.sample(study, CALIBRATION, (1, 2))))
    part = model.only(model.outputs_[:OUTPUTS])
    X = np.stack([np.resize(xr.DataArray(column).values, QUERIES) for column in points.values()], axis=1)
    query_cost = timed(lambda: part.interval_array(X))[1]
    return {
        "data set [s]": solved.processor,
        "fit [s]": fitted.processor,
        "error, plain mean": plain,
        "error, corrected": error(),
        f"a million queries of {OUTPUTS} outputs with intervals [s]": query_cost.processor,
        "a million exact cases, fifty at a place [s]": exact.processor * QUERIES / FRESH,
    }
