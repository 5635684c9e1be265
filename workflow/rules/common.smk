# What the other files need: the study behind a wildcard, and the hashes that say when a job must run again.
#
# Priorities, in all files: random cases and the slabs first, then what stands between them and the validation, for which a run waits
# longest; cards, figures and the rest fill the cores that this leaves idle.

import sys
from functools import cache
from itertools import count

from workflow.dataset import batches, casecache
from workflow.design.verdict import netcdf
from workflow.report import sections as page_sections
from workflow.run import lock, provenance
from workflow.run.interpreter import quote_interpreter
from workflow.study import configuration, coupling, location, partition, planned
from workflow.study import model as studies
from workflow.study.contents import BOX, PHYSICS
from workflow.study.sections import CHECK_GROUPS

quote_interpreter()
# jobs look for modules where this process does
sys.path.insert(0, str(provenance.ROOT))

SOURCES = provenance.digests()  # as they are planned with: a job that finds others refuses
STUDIES = set()  # those that this run needs
SECTIONS = set()  # names of sections in the rules' parameters
DESIGNED = set()  # those whose designs it needs
RESULTS = workflow.modifier.path_modifier.replace_prefix("results")  # where a module's `prefix:` puts them

try:
    main = workflow.modifier.is_main_snakefile()  # a module has the configuration that its parent gives, and no other
    entries = partition.settle(workflow.config_settings.config_args, planner=workflow.is_main_process)
    read = {key: value for key, value in config.items() if key != partition.AT_ONCE or workflow.is_main_process}
    STUDY = location.given(configuration.study(read, entries if main else ()))
    if main and workflow.is_main_process:
        workflow.config_settings.config_args = entries
    if main and workflow.is_main_process and "snakemake" in (Path(sys.argv[0]).stem, Path(sys.argv[0]).parent.name):
        configuration.check_profiles(sys.argv[1:])
except studies.InputError as error:
    raise WorkflowError(str(error))


def before(theirs, ours):
    """A handler that calls ours, then theirs."""

    def both(log):
        ours()
        theirs(log)

    return both


@cache
def study_named(name):
    """The checked study, on a cluster's node as it was when the run began; bad input ends the run with one line."""
    try:
        return (workflow.remote_exec and planned.begun(name, RESULTS)) or partition.with_slabs(studies.named(name))
    except studies.InputError as error:
        raise WorkflowError(str(error))


def study_of(wildcards):
    STUDIES.add(wildcards.study)
    return study_named(wildcards.study)


def sections(*names):
    """A parameter that changes when these sections of the study change, all of them by default; see `planned`.

    Wildcards in the names are filled in.
    """
    SECTIONS.add(names)
    return lambda wildcards: planned.parameter(study_of(wildcards), *(name.format(**wildcards) for name in names))


def presses_other(study):
    """Whether the design that is pressed in time is that of another study, which this run then makes as well."""
    name = study.signal.study if study.signal else ""
    if not name:
        return False
    try:
        if not workflow.remote_exec:
            studies.pressed(study)
    except studies.InputError as error:
        raise WorkflowError(str(error))
    STUDIES.add(name)
    return True


def states_of(name, others=True):
    """The parameters of all rules of a study and of the other that it presses, by which jobs know files that they read."""
    study = study_named(name)
    labels = [*study.design, *study.readout, ""]
    filled = {tuple(part.format(name=label, group="") for part in names) for names in SECTIONS for label in labels}
    states = {planned.parameter(study, *names) for names in filled}
    if others and presses_other(study):  # two studies may press each other's designs
        states |= states_of(study.signal.study, others=False)
    return states


def final_files_of(name):
    """What a run of a study makes last."""
    return [f"results/{name}/{file}" for file in study_named(name).final_files]


def of_designs(file):
    """A file of every target of a study."""
    return lambda wildcards: expand(file, study=wildcards.study, name=study_of(wildcards).design)


def designs_of(wildcards):
    """The answers to the targets of a study."""
    DESIGNED.add(wildcards.study)
    return of_designs("results/{study}/design/{name}.nc")(wildcards)


def pressed_of(wildcards):
    """The answer whose punch is pressed in time."""
    study = study_of(wildcards)
    presses_other(study)
    return f"results/{study.signal.study or wildcards.study}/design/{study.signal.design}.nc"


def opening_of(wildcards):
    """What was solved of the design of another study that stands first on the page."""
    study = study_of(wildcards)
    return [f"results/{study.signal.study}/solved.json"] if presses_other(study) else []


def levels_of(wildcards):
    """The file of the chosen levels, where the study leaves some open."""
    return [f"results/{wildcards.study}/levels.nc"] if study_of(wildcards).open else []


def figures_of(wildcards):
    """The figures of the page's sections, but those of designs."""
    names = page_sections.figures(study_of(wildcards))
    return expand("results/{study}/figures/{figure}.svg", study=wildcards.study, figure=names)


def drawn_from(file):
    """The results that figures read, or all slabs of the data set."""
    path = f"results/{{study}}/{file}"
    return (lambda wildcards: slabs_of(wildcards, path)) if "{slab}" in file else path


def results_of(wildcards):
    study = study_of(wildcards)
    names = ["quantities.nc", "datacard.json", "surrogate.nc", "validation.nc", "sensitivity.nc", "timing.json"]
    names = names if study.factors else []
    names += ["surface.nc", "surface_validation.nc"] if study.factors and study.surrogate.fields else []
    names += ["design.nc", "design.csv"] if study.design else []
    names += [f"readout/{name}.nc" for name in study.readout]
    names += ["signal.nc"] if study.signal else []
    names += page_sections.effects(study)
    names += ["sweeps.nc"] if study.effects and study.effects.of_baseline else []
    names += [f"verification/{group}.json" for group in CHECK_GROUPS if study.verification]
    names += ["measured/measurements.json", "measured/measurements.nc"] if study.measurements else []
    return expand("results/{study}/{file}", study=wildcards.study, file=names)


def fields_felt(wildcards):
    """A parameter: the fields of a study's cases."""
    return sorted(coupling.fields(study_of(wildcards)))


def learned_quantities(wildcards):
    """A parameter: names of the surrogate's outputs that the page shows."""
    return coupling.outputs(study_of(wildcards))


CAPTIONS = sorted(f"workflow/report/captions/{file.name}" for file in (provenance.ROOT / "workflow/report/captions").glob("*.rst"))


def regions_of(wildcards):
    """A parameter that changes when exact cases are to have other curves."""
    return study_of(wildcards).regions


def curves_of(wildcards):
    """The slabs, where the surrogate learns curves that lie in them."""
    return slabs_of(wildcards, "results/{study}/fields/slab_{slab}.nc") if study_of(wildcards).regions else []


def batches_of(wildcards, rounds=None):
    """The slabs of the batches that a cross approximation asks for, of the first rounds or of all."""
    files = []
    for number in count() if rounds is None else range(rounds):
        places = checkpoints.places.get(study=wildcards.study, round=number).output[0]
        slabs = range(batches.slabs(study_of(wildcards), places))
        if not slabs:
            break
        files += expand("results/{study}/cross/{round}_{slab}.nc", study=wildcards.study, round=number, slab=slabs)
    return files


def slabs_of(wildcards, file):
    """The slabs of the data set, a file each."""
    if study_of(wildcards).crossed:
        return batches_of(wildcards)
    return expand(file, study=wildcards.study, slab=range(partition.count(study_of(wildcards))))
