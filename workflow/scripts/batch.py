"""Rule batch: exact quantities of one slab of a batch that a cross approximation asks for."""

from pathlib import Path

from workflow.dataset import batches
from workflow.dataset.kept import Kept
from workflow.run import joblog, lock
from workflow.study import planned

snakemake = joblog.start(globals())
config = planned.study(snakemake)
output = Path(snakemake.output[0])
kept = Kept(lock.results(snakemake.wildcards.study, output), output)
batches.write_slab(config, Path(snakemake.input[0]), int(snakemake.wildcards.slab), output, kept)
kept.tell()
