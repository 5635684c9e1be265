"""Rule slab: exact quantities and fields of one slab of the factorial."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from workflow.dataset import levels, slabs
from workflow.run import joblog
from workflow.study import planned

snakemake: Snakemake

joblog.start(snakemake.log[0])
config = levels.resolved(planned.study(snakemake.wildcards.study, snakemake.params.study), snakemake.input.levels)
slabs.write_slab(config, int(snakemake.wildcards.slab), Path(snakemake.output[0]))
