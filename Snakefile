# The whole pipeline: one study (config/<study>.yaml) becomes results/<study>/report.html.
#
#   slab -> quantities -> surrogate -> validation -> design -> figures -> report        (a study with `factors`)
#   effect -> figures -> report                                                        (a study with `effects`)
#   check -> figures -> report -> verdict                                              (a study with `verification`)
#
# `make run STUDY=name` or `snakemake results/name/report.html`; any file below results/ can be asked for by name.

from snakemake.utils import min_version

min_version("9.20")

report: "workflow/captions/workflow.rst"

wildcard_constraints:
    study="[A-Za-z0-9][A-Za-z0-9_-]*",
    slab="[0-9]+",
    name="[A-Za-z0-9_]+",
    group="[a-z_]+",

include: "workflow/rules/common.smk"
include: "workflow/rules/dataset.smk"
include: "workflow/rules/surrogate.smk"
include: "workflow/rules/design.smk"
include: "workflow/rules/effects.smk"
include: "workflow/rules/verification.smk"
include: "workflow/rules/report.smk"

# seconds each: not worth a job on a cluster
localrules: all, design, figure_fields, figure_errors, figure_design, figure_effect, provenance, report

onstart:
    # one run a study at a time; `nolock` in the profile leaves this to us
    try:
        running.claim(STUDIES)
    except running.BusyError as error:
        raise WorkflowError(str(error))
    running.sweep(STUDIES)

onsuccess:
    unreached.tell(DESIGNED)


rule all:
    default_target: True
    input:
        targets_of(config.get("study", "quickstart")),
