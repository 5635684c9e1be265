"""Numbers of levels that a study leaves open: chosen from pilots for its tolerance, and filled in."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from storage.described import described
from storage.netcdf import read_whole
from surrogate.data.meanings import MEANINGS, SOURCE
from surrogate.levels.counts import explore
from workflow.dataset import factorial
from workflow.run.joblog import log
from workflow.study import partition
from workflow.study.categories import parted
from workflow.study.grouped import product
from workflow.study.model import Study
from workflow.study.reading import InputError

_MEANINGS = {
    "levels": "number of levels of every input",
    "pilot_levels": "number of levels of every input in the last pilot",
    "given": "1 where the study says the number of levels",
    "affine": "1 where every output is affine in the input",
    "extrapolated": "1 where the number was extrapolated from the pilot",
    "predicted_error": "predicted largest error over range",
}


def choose(study: Study) -> xr.Dataset:
    """Return level counts for ``validation.tolerance`` within ``dataset.budget``, and the evidence for them."""
    fixed_counts = {name: axis.levels for name, axis in study.axes.items() if axis.levels is not None}

    def solve(axes: dict[str, np.ndarray[tuple[int, ...], np.dtype[np.float64]]]) -> xr.Dataset:
        log.info("pilot of %s", " x ".join(f"{axis.size} {name}" for name, axis in axes.items()))
        return factorial.scaled(study, factorial.training_data(study, factorial.exact(study, axes)), grouping)

    grouping = factorial.grouping(study) if study.groups else None
    tolerance, budget = study.validation.tolerance, study.dataset.budget
    pilot = explore(solve, factorial.axis_inputs(study), tolerance, budget, study.output_names, fixed_counts)
    choice = pilot.choice
    for name, where in choice.kinked.items():
        log.warning("%s is kinked along %s: no tolerance is claimed for it", name, ", ".join(where))
        if parted(name)[0] in study.surrogate.outputs:
            raise InputError(
                f"surrogate: outputs: {name!r} is kinked along {', '.join(where)} (its Chebyshev coefficients fall "
                f"like a power): tolerance {tolerance:g} cannot be promised; leave it out or give every factor levels"
            )
    names = list(choice.counts)
    counts = dict(choice.counts)
    # every slab needs a level of the first axis
    first = next(iter(study.axes))
    counts[first] = max(counts[first], partition.count(study))
    chosen = choice.decay.assign(
        levels=("input", [counts[name] for name in names]),
        pilot_levels=("input", [pilot.levels[name] for name in names]),
        given=("input", [int(name in fixed_counts) for name in names]),
        affine=("input", [int(name in choice.affine) for name in names]),
        extrapolated=("input", [int(name in choice.extrapolated) for name in names]),
        predicted_error=("output", list(choice.error.values())),
    )
    title = "numbers of levels chosen for a tolerance"
    return described(chosen, title, SOURCE, MEANINGS | _MEANINGS).assign_attrs(
        tolerance=tolerance, budget=budget, pilot_cases=pilot.cases
    )


def with_levels(study: Study, files: Sequence[str | Path]) -> Study:
    """Return the study with the chosen level counts."""
    if not files:
        return study
    chosen = read_whole(Path(files[0]))
    counts = {str(name): int(chosen["levels"].sel(input=name)) for name in chosen["input"].values}
    parts: dict[str, Any] = {"factors": {}, "groups": {}}
    for text, group in study.groups.items():
        parts["groups"][text] = group.model_copy(update={"levels": counts[product(text).name]})
    for name, axis in study.factors.items():
        parts["factors"][name] = axis.model_copy(update={"levels": counts[name]}) if not study.groups else axis
    # as many slabs as the rules counted before any level was chosen
    return partition.with_slabs(study).model_copy(update=parts)
