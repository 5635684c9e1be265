"""Rule batch: exact quantities of one slab of a batch that a cross approximation asks for."""

from pathlib import Path

from workflow.dataset import batches, casecache
from workflow.study import planned

snakemake, config = planned.start(globals())
with casecache.of(snakemake) as cache:
    batches.write_slab(
        config, Path(snakemake.input[0]), int(snakemake.wildcards.slab), Path(snakemake.output[0]), cache
    )
