"""Rule slab: exact quantities and fields of one slab of the factorial."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from workflow import choice, dataset, joblog, planned

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = choice.resolved(planned.study(snakemake.wildcards.study, snakemake.params.study), snakemake.input.levels)
dataset.write_slab(config, int(snakemake.wildcards.slab), Path(snakemake.output[0]))
