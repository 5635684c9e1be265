"""Rule verdict: the run fails if a check is red; the page is there by then."""

from pathlib import Path

from storage.files import write_text
from workflow.report import verification
from workflow.run import joblog

snakemake = joblog.start(globals())
write_text(Path(snakemake.output[0]), verification.verdict([Path(file) for file in snakemake.input.checks]))
