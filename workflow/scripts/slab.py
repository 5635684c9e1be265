"""Rule slab: exact quantities and fields of one slab of the factorial."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from surrogate.netcdf import write_whole
from workflow import choice, factorial, joblog, study

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = choice.resolved(study.named(snakemake.wildcards.study), snakemake.input.levels)
write_whole(factorial.slab(config, int(snakemake.wildcards.slab)), Path(snakemake.output[0]))
