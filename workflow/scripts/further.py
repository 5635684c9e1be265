"""Rule further: exact answers to a part of the cases that the surrogate asks for."""

from pathlib import Path

from workflow.dataset import casecache, infill
from workflow.run import joblog
from workflow.study import planned

snakemake = joblog.start(globals())
config = planned.study(snakemake)
with casecache.of(snakemake) as cache:
    infill.write_slab(config, Path(snakemake.input[0]), int(snakemake.wildcards.slab), Path(snakemake.output[0]), cache)
