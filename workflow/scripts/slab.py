"""Rule slab: exact quantities and fields of one slab of the factorial."""

from pathlib import Path

from workflow.dataset import casecache, levels, slabs
from workflow.study import planned

snakemake, config = planned.start(globals())
config = levels.with_levels(config, snakemake.input.levels)
with casecache.of(snakemake) as cache:
    slabs.write_slab(config, int(snakemake.wildcards.slab), Path(snakemake.output[0]), cache)
