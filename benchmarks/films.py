"""Films over groups: what data sets of two sizes cost, their errors, and a million queries beside the exact solver.

``python -m benchmarks films``; times are processor time. The box is that of `config/film.yaml`, seven factors.
"""

import numpy as np
import xarray as xr

from benchmarks.timing import timed
from workflow.dataset import factorial
from workflow.learning import training
from workflow.run.provenance import ROOT
from workflow.study import model as studies
from workflow.study.model import Study

#: Levels of volume fraction, friction, P R/h^2, T/P and J/P.
LEVELS = {"4,608 cases": (8, 4, 12, 4, 3), "36,800 cases": (16, 5, 23, 5, 4)}
BASES = ("rigid", "steel")
#: Queries that are counted, and outputs that each of them asks for.
QUERIES, OUTPUTS = 1_000_000, 21


def measure(fresh: int = 1000, held: int = 2500, queries: int = QUERIES) -> dict[str, float]:
    """Seconds and largest errors over range on fresh cases, before and after the calibration, for every base."""
    whole = studies.load(ROOT / "config" / "film.yaml")
    measured: dict[str, float] = {}
    for base in BASES:
        for name, levels in LEVELS.items():
            study = _alone(whole, base, levels)
            measured |= {
                f"{base}, {name}: {what}": value for what, value in _measured(study, fresh, held, queries).items()
            }
    return measured


def _alone(whole: Study, base: str, levels: tuple[int, ...]) -> Study:
    """The study of films on one base, with these levels of its groups."""
    groups = {
        text: group.model_dump() | {"levels": count}
        for (text, group), count in zip(whole.groups.items(), levels, strict=True)
    }
    fixed = {**whole.fixed, "base": base}
    return studies.remade(whole, fixed=fixed, categories={}, groups=groups, design={}, readout={})


def _measured(study: Study, fresh: int, held: int, queries: int) -> dict[str, float]:
    """Return the costs of one data set, its fit and its queries, and the errors before and after the correction."""
    data, solved = timed(lambda: factorial.exact(study, factorial.axes(study)))
    model, fitted = timed(lambda: training.fit(study, data))
    truth, exact = timed(lambda: factorial.sample(study, fresh, (1, 0)))
    points = {name: truth[name] for name in study.factors}
    true = factorial.training_data(study, truth)

    def error() -> float:
        errors = model.predict(points, return_std=False) - true
        return max(float(abs(errors[name]).max() / np.ptp(true[name].values)) for name in model.outputs_)

    plain = error()
    model.calibrate(factorial.training_data(study, factorial.sample(study, held, (1, 2))))
    part = model.only(model.outputs_[:OUTPUTS])
    X = np.stack([np.resize(xr.DataArray(column).values, queries) for column in points.values()], axis=1)
    query_cost = timed(lambda: part.interval_array(X))[1]
    return {
        "data set [s]": solved.processor,
        "fit [s]": fitted.processor,
        "error, plain mean": plain,
        "error, corrected": error(),
        f"a million queries of {OUTPUTS} outputs with intervals [s]": query_cost.processor * QUERIES / queries,
        "a million exact cases, fifty at a place [s]": exact.processor * QUERIES / fresh,
    }
