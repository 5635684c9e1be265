"""Rule slab: exact quantities and fields of one slab of the factorial."""

from pathlib import Path

from workflow.dataset import levels, slabs
from workflow.dataset.kept import Kept
from workflow.run import joblog, lock
from workflow.study import planned

snakemake = joblog.start(globals())
config = levels.with_levels(planned.study(snakemake), snakemake.input.levels)
output = Path(snakemake.output[0])
kept = Kept(lock.results(snakemake.wildcards.study, output), output)
slabs.write_slab(config, int(snakemake.wildcards.slab), output, kept)
kept.tell()
