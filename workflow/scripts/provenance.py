"""Rule provenance: versions, hashes and the seed behind a study's results."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from workflow.run import joblog, provenance
from workflow.study import location

snakemake: Snakemake

joblog.start(snakemake.log[0])
results = [Path(result) for result in snakemake.input]
output = Path(snakemake.output[0])
study = location.from_results(snakemake.wildcards.study, output.parent)
provenance.write(output, study, snakemake.params.study, snakemake.params.seed, results)
