"""Rule provenance: versions, hashes and the seed behind a study's results, and the study as it began."""

from pathlib import Path

from storage.files import write_text
from workflow.run import joblog, lock, provenance
from workflow.study import location

snakemake = joblog.start(globals())
results = [Path(result) for result in snakemake.input]
name, output = snakemake.wildcards.study, Path(snakemake.output.provenance)
study = location.from_results(name, output.parent)
provenance.write(output, study, snakemake.params.study, snakemake.params.seed, results)
begun = lock.begun(name, output.parents[1])  # without an edit during the run
text = begun["text"] if begun else location.location(name).read_text(encoding="utf-8")
write_text(Path(snakemake.output.study), text)
