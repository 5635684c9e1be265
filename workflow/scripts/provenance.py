"""Rule provenance: versions, hashes and the seed behind a study's results."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from workflow import joblog, provenance

snakemake: Snakemake

joblog.start(snakemake.log[0])
results = [Path(result) for result in snakemake.input]
provenance.write(Path(snakemake.output[0]), snakemake.params.study, snakemake.params.seed, results)
