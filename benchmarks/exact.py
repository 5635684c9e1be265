"""Cost of the exact solver a case: in a factorial, scattered, alone; and of what it searches for over the body."""

import numpy as np

from workflow.dataset import factorial
from workflow.learning.timing import seconds
from workflow.run.provenance import ROOT
from workflow.study.model import load


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
    }
