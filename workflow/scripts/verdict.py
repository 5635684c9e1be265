"""Rule verdict: the run fails if a check is red; the page is there by then."""

from pathlib import Path

from snakemake.iocontainers import Snakemake

from workflow import joblog, verdict
from workflow.files import write_text

snakemake: Snakemake

joblog.start(snakemake.log[0])
write_text(Path(snakemake.output[0]), verdict.verdict([Path(file) for file in snakemake.input.checks]))
