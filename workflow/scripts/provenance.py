"""Rule provenance: versions, hashes and the seed behind a study's results."""

from pathlib import Path

from workflow.run import joblog, provenance
from workflow.study import location

snakemake = joblog.start(globals())
results = [Path(result) for result in snakemake.input]
output = Path(snakemake.output[0])
study = location.from_results(snakemake.wildcards.study, output.parent)
provenance.write(output, study, snakemake.params.study, snakemake.params.seed, results)
