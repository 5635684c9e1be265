"""Rule provenance: versions, hashes and the seed behind a study's results, and the crate that they make."""

from pathlib import Path

from workflow.run import joblog, provenance
from workflow.study import location

snakemake = joblog.start(globals())
results = [Path(result) for result in snakemake.input]
name, output = snakemake.wildcards.study, Path(snakemake.output.provenance)
study = location.from_results(name, output.parent)
provenance.write(output, study, snakemake.params.study, snakemake.params.seed, results)
provenance.write_crate(output.parent, name, snakemake.params.title, study, [*results, output], snakemake.params.last)
