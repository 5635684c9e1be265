# What the other files need: the study behind a wildcard, and the hashes that say when a job must run again.

from functools import cache

from workflow import factorial, provenance
from workflow import study as studies
from workflow.study import CHECK_GROUPS, CONVERGING


@cache
def study_named(name):
    """The checked study; bad input ends the run with one line."""
    try:
        return studies.named(name)
    except studies.InputError as error:
        raise WorkflowError(str(error))


def study_of(wildcards):
    return study_named(wildcards.study)


def sections(*names):
    """A parameter that changes when these sections of the study change."""
    return lambda wildcards: study_of(wildcards).digest(*names)


PHYSICS = ("phases", "materials", "fixed", "factors")


def targets_of(name):
    """What a run of a study makes last."""
    return [f"results/{name}/{file}" for file in study_named(name).targets]


def figures_of(wildcards):
    study = study_of(wildcards)
    names = ["fields", "errors", "parity", "intervals"] if study.factors else []
    names += [f"design_{name}" for name, target in study.design.items() if len(target.over) > 1]
    names += [f"effect_{name}" for name in (study.effects.vary if study.effects else [])]
    names += [f"convergence_{group}" for group in CONVERGING if study.verification]
    return expand("results/{study}/figures/{figure}.svg", study=wildcards.study, figure=names)


def results_of(wildcards):
    study = study_of(wildcards)
    names = ["quantities.nc", "surrogate.nc", "validation.nc", "timing.json"] if study.factors else []
    names += ["design.nc", "design.csv"] if study.design else []
    names += [f"fields/effect_{name}.nc" for name in (study.effects.vary if study.effects else [])]
    names += [f"verification/{group}.json" for group in CHECK_GROUPS if study.verification]
    return expand("results/{study}/{file}", study=wildcards.study, file=names)


def captions_of(*kinds):
    return [f"workflow/captions/{kind}.rst" for kind in kinds]
