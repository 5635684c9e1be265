"""Rule slab: exact quantities and fields of one slab of the factorial."""

from pathlib import Path

from workflow.dataset import levels, slabs
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
config = levels.with_levels(planned.study(snakemake), snakemake.input.levels)
slabs.write_slab(config, int(snakemake.wildcards.slab), Path(snakemake.output[0]))
