# The pipeline stands in the package, so that an installed program has all that it runs: workflow/Snakefile shows it whole.
#
# `make run STUDY=name` or `snakemake results/name/report.html`; `snakemake --rulegraph` draws it.

include: "workflow/Snakefile"

workflow.default_target = "all"  # which an include keeps to itself
