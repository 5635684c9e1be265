"""Being a Snakemake job: the lock of a study, the log, and what a result depends on."""
